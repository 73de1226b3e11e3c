"""Axes of an arm file that the penalty method keeps, although the modes do not bear them out.

Eq. (13) of file 002 fits joints alone; an axis of the file stays as it is. One that is not there
takes its share of every frequency, and the joints beside it come out too stiff.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.structure import Structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.analyzer.identification.penalty import PenaltyFit, fit_by_penalty
from armodal.protocols.errors import EstimateError

__all__ = ["DoubtedAxis", "doubted_axes"]


@dataclass(frozen=True, slots=True, kw_only=True)
class DoubtedAxis:
    """An axis without which the modes are met as many and better."""

    link: str
    rms_with_hz: float  # of the paired modes' frequencies
    rms_without_hz: float


def doubted_axes(
    superset: Superset,
    structure: Structure,
    postures: tuple[MeasuredModes, ...],
    fit: PenaltyFit,
    *,
    added_mass_kg: tuple[npt.NDArray[np.float64], ...],
) -> tuple[DoubtedAxis, ...]:
    """Fit again without each axis of the structure that the fit began with."""
    found = []
    for number, axis in enumerate(structure.axes):
        others = structure.axes[:number] + structure.axes[number + 1 :]
        try:
            without = fit_by_penalty(
                superset,
                replace(structure, axes=others),
                postures,
                fit.chosen,
                added_mass_kg=added_mass_kg,
            )
        except EstimateError:  # the joints cannot be told without it
            continue
        rms_hz = [np.sqrt(own.penalty_hz2 / len(own.pairs)) for own in (fit, without)]
        if without.left_out <= fit.left_out and rms_hz[1] < rms_hz[0]:
            found.append(
                DoubtedAxis(
                    link=superset.arm.joints[axis.link].link.name,
                    rms_with_hz=float(rms_hz[0]),
                    rms_without_hz=float(rms_hz[1]),
                )
            )
    return tuple(found)
