"""The modes of a corrected arm in a posture, with what its file leaves uncertain of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.wanted_posture import wanted_posture
from armodal.analyzer.corrected.correction import Correction, correction_of, stepped
from armodal.analyzer.corrected.modes import CorrectedModes, corrected_modes
from armodal.analyzer.corrected.posture import CorrectedPosture, corrected_posture, stand
from armodal.analyzer.identification.mode_fit import pair_by_shape
from armodal.protocols.arm.records import Arm

__all__ = ["ArmPrediction", "modes_of_arm", "predict_arm"]

Array = npt.NDArray[np.float64]

_STEP = 0.1  # of a deviation, for slopes: their bend within it is a hundredth of them


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmPrediction:
    """Modes of one posture, no sensor on the arm."""

    arm: Arm
    posture_deg: tuple[float, ...]
    posture: CorrectedPosture
    modes: CorrectedModes
    f_std_hz: Array  # (m,)
    damping_std: Array  # (m,)
    strain_share: Array  # (n, m) of each coordinate's own spring
    notes: tuple[str, ...]


def predict_arm(
    arm: Arm,
    postures_deg: Sequence[Sequence[float]],
    *,
    level: float = 0.0,
    below_hz: float = np.inf,
) -> tuple[ArmPrediction, ...]:
    """Predict modes from an arm file alone, its effects included.

    Standard deviations of joints' springs and dampers and of the effects' parameters are taken as
    the file has them, each by itself: it holds no correlations.

    Parameters
    ----------
    level
        ln of the hits' peak force over the middle of the test's, for laws of amplitude.
    below_hz
        Modes above are left out.

    Raises
    ------
    ArmError
        If a posture or an effect is not the arm's.
    EstimateError
        If nothing oscillates in a posture.
    """
    correction = correction_of(arm)
    steps = tuple(_steps(correction))
    found = []
    for posture_deg in postures_deg:
        q = wanted_posture(arm, posture_deg)
        own, modes = _modes(correction, q, level, below_hz)
        slopes = np.array(
            [_moved(modes, own, stepped(correction, step), q, level) for step in steps]
        ).reshape(len(steps), 2, -1)
        f_std, damping_std = np.sqrt(np.sum((slopes / _STEP) ** 2, axis=0))
        energy = np.diag(own.stiffness)[:, None] * np.abs(modes.shape) ** 2
        found.append(
            ArmPrediction(
                arm=arm,
                posture_deg=tuple(posture_deg),
                posture=own,
                modes=modes,
                f_std_hz=f_std,
                damping_std=damping_std,
                strain_share=energy / energy.sum(axis=0),
                notes=correction.notes,
            )
        )
    return tuple(found)


def modes_of_arm(
    arm: Arm, postures_deg: Sequence[Sequence[float]], *, below_hz: float = np.inf
) -> tuple[CorrectedModes, ...]:
    """Predict as `predict_arm` does, but modes alone: without deviations it is done far sooner.

    Raises
    ------
    ArmError, EstimateError
        As `predict_arm` does.
    """
    correction = correction_of(arm)
    return tuple(
        _modes(correction, wanted_posture(arm, posture_deg), 0.0, below_hz)[1]
        for posture_deg in postures_deg
    )


def _steps(correction: Correction) -> Iterator[Mapping[str, float]]:
    """A part of a deviation of every value the file gives one for."""
    for joint in correction.ordinary.arm.joints:
        for what, estimate in (("k", joint.stiffness), ("c", joint.damping)):
            if joint.stiffness is not None and estimate is not None and estimate.value > 0.0:
                yield {f"ln {what} {joint.name}": _STEP * estimate.std / estimate.value}
    for name, _, std in correction.names:
        if std > 0.0:
            yield {name: _STEP * std}


def _modes(
    correction: Correction, q: Array, level: float, below_hz: float
) -> tuple[CorrectedPosture, CorrectedModes]:
    posture = corrected_posture(correction, stand(correction, q), level=level)
    return posture, corrected_modes(posture, below_hz=below_hz)


def _moved(
    modes: CorrectedModes, own: CorrectedPosture, other: Correction, q: Array, level: float
) -> Array:
    """(2, m) changes of frequency and damping ratio, each mode with the one it became."""
    changed, there = _modes(other, q, level, np.inf)
    rows = [changed.names.index(name) for name in own.names if name in changed.names]
    here = [own.names.index(name) for name in own.names if name in changed.names]
    pairs = sorted(pair_by_shape(modes.shape[here], there.shape[rows]))
    at = [j for _, j, _ in pairs]
    return np.array([there.f_hz[at] - modes.f_hz, there.damping_ratio[at] - modes.damping_ratio])
