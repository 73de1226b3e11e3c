"""Slopes of a response with a joint's own law, from swings a step to either side of a point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.law_in_place import on_lines, with_a_torque
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.posed import Postures
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["own_spring", "slope_of", "steps_of"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]
_Values = Mapping[str, float]

_STEP = 0.02  # to either side, of a parameter's prior deviation


def own_spring(plain: Hypothesis, joint: str) -> tuple[Parameter, ...]:
    """Return ln k and ln c of a joint."""
    names = {f"ln {what} {joint}" for what in "kc"}
    return tuple(p for p in plain.space().parameters if p.name in names)


def steps_of(values: _Values, parameter: Parameter) -> tuple[dict[str, float], dict[str, float]]:
    """Return the values with a parameter a step back and a step on, but within its bounds."""
    name, step = parameter.name, _STEP * parameter.std
    ends = max(values[name] - step, parameter.low), min(values[name] + step, parameter.high)
    return {**values, name: ends[0]}, {**values, name: ends[1]}


def slope_of(
    plain: Hypothesis,
    joint: str,
    groups: Sequence[tuple[list[int], Postures]],
    lines: Sequence[PostureLines],
    name: str,
    ends: tuple[_Values, _Values],
    swung: tuple[Sequence[tuple[Array, Array]], Sequence[tuple[Array, Array]]],
) -> dict[tuple[object, ...], ComplexArray]:
    """Return how the response (m, 3, L) with a law changes a unit of a parameter.

    Parameters
    ----------
    plain, joint
        The model without the law, and the joint it acts in.
    groups, lines
        Postures and levels, solved together by their numbers.
    name, ends, swung
        The parameter, the values a step back and a step on, and at each the turns and torques
        (1, m, n_steps) on each of the lines.

    Returns
    -------
        By the lines' key.
    """
    back, on = (
        {
            p: plainly - load * on_lines(lines[p], own[p][1][0])[:, None]
            for p, (plainly, load) in with_a_torque(plain, joint, groups, values).items()
        }
        for values, own in zip(ends, swung, strict=True)
    )
    step = ends[1][name] - ends[0][name]
    return {lines[p].key: (on[p] - back[p]) / step for p in back}
