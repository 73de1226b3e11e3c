"""A spring and a damper in the place of a joint's own law, and the law's torque on lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.posed import Postures
from armodal.analyzer.gap.model.steps import STEPS
from armodal.analyzer.gap.model.swings import pulse

__all__ = ["joint_row", "on_lines", "with_a_torque", "with_springs"]

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
    at = STEPS.weights_s[:, None] * np.exp(-np.outer(STEPS.seconds, s))
    return np.asarray(torque @ at / force)


def with_a_torque(
    plain: Hypothesis,
    joint: str,
    groups: Sequence[tuple[list[int], Postures]],
    values: Mapping[str, float],
) -> dict[int, tuple[ComplexArray, ComplexArray]]:
    """Return the response (m, 3, L) of a model, and what a unit torque of a joint adds to it.

    By the numbers of postures and levels; `groups` of them are solved together.
    """
    found: dict[int, tuple[ComplexArray, ComplexArray]] = {}
    for used, together in groups:
        response = together.response(plain, values)
        rows = np.stack([joint_row(own, joint) for own in together.assembled(plain, values)])
        loads = response.under_a_torque(rows)
        found |= dict(zip(used, zip(response.values, loads, strict=True), strict=True))
    return found
