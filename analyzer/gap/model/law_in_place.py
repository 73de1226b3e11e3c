"""A spring and a damper in the place of a joint's own law, and the law's torque on lines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.swings import STEP_S, pulse, seconds

__all__ = ["joint_row", "on_lines", "with_springs"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_SPRING = EffectWords(name="in place", title="Spring in a law's place", changes="", signature="")


def joint_row(assembly: Assembly, joint: str) -> Array:
    """Return (n,) by which a joint's spring stretches."""
    row = np.zeros(len(assembly.columns))
    stretch = assembly.joint_row(joint)
    row[: stretch.size] = stretch
    return row


def with_springs(
    plain: Hypothesis, joint: str, springs: Mapping[tuple[object, ...], tuple[float, float]]
) -> Hypothesis:
    """Return the hypothesis with what a joint's law adds to ln k and ln c, by the lines' key."""

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        assembly.multiply_spring(joint, values, *springs[assembly.lines.key])

    in_its_place = Instance(
        effect=_SPRING, place=joint, builder=build, level_dependent=True, is_term=True
    )
    return replace(plain, instances=(*plain.instances, in_its_place))


def on_lines(own: PostureLines, torque: Array) -> ComplexArray:
    """Return (..., m, L) a N of the force of each mounting's hit, of torques (..., m, n_steps)."""
    s = own.s_rad_s
    force = np.stack([pulse(s, float(peak), own.width_s) for peak in own.peaks_n])
    return np.asarray(torque @ (STEP_S * np.exp(-np.outer(seconds(), s))) / force)
