"""By how much a law linearised about a point answers every parameter of the model around it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.joint_laws import JointLaw, Linearised, stacked
from armodal.analyzer.gap.model.law_in_place import joint_row, on_lines, with_springs
from armodal.analyzer.gap.model.law_slopes import tangents_along, torque_slopes
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.posed import PosedModel, Postures

__all__ = ["with_all_slopes"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


def with_all_slopes(
    about: Linearised,
    plain: Hypothesis,
    law: JointLaw,
    groups: Sequence[tuple[list[int], Postures]],
    models: Sequence[PosedModel],
    lines: Sequence[PostureLines],
    values: Mapping[str, float],
    by_steps: Mapping[str, Array],
    followed: Sequence[tuple[Array, Array]],
    own_slopes: Mapping[str, Mapping[tuple[object, ...], ComplexArray]],
) -> Linearised:
    """Return it with what all other parameters change in what springs and dampers leave.

    A compliance that rests at none is left out: the torque's way through it is not solved for.

    Parameters
    ----------
    about
        Exact at a point.
    plain, law, values
        The model without the law, the law, and the point.
    groups
        Postures and levels that are solved together, by their numbers.
    models, lines
        Of each posture and level.
    by_steps
        The joint's turns by a torque in each posture, by its name (`swings.Swings`).
    followed
        Turns and torques (1 or more, m, n_steps) on each of the lines, first those there.
    own_slopes
        By parameter and the lines' key, how the response (m, 3, L) with the law changes a unit of
        it: of the joint's own spring and damper, from swings to either side.
    """
    springs = {key: (own.log_k, own.log_c) for key, own in about.table.items()}
    near = with_springs(plain, law.joint, springs)
    space = plain.space()
    table = dict(about.table)
    counts = [len(turn[0]) for turn, _ in followed]
    geometries = [model.geometry(plain.ordinary, values) for model in models]
    every = [
        law.element(values, law.load_n_m(geometry, own.known_mass))
        for geometry, own in zip(geometries, lines, strict=True)
    ]
    tangents = tangents_along(
        stacked(every, counts),
        np.concatenate([turn[0] for turn, _ in followed]),
    )
    ends = np.cumsum(counts)
    for used, together in groups:
        assemblies = together.assembled(plain, values)
        rows = np.stack([joint_row(assembly, law.joint) for assembly in assemblies])
        torques = np.stack([followed[p][1][0] for p in used])
        swings = np.stack([np.arange(ends[p] - counts[p], ends[p]) for p in used])
        own_steps = np.stack([by_steps[lines[p].name] for p in used])
        changes = torque_slopes(
            together, plain, space, values, rows, own_steps, tangents.of(swings), torques
        )
        loads = together.response(plain, values).under_a_torque(rows)
        held = [on_lines(lines[p], torque) for p, torque in zip(used, torques, strict=True)]
        slopes = together.derivatives_holding_back(plain, space, values, rows, np.stack(held))
        by_near = together.derivatives(near, space, values)[1]
        slopes -= by_near
        for i, (p, assembly) in enumerate(zip(used, assemblies, strict=True)):
            own = lines[p]
            here = slopes[:, i] - loads[i] * changes[:, i, :, None]
            rests = {name for name in assembly.compliance_of if values[name] == 0.0}
            by = dict(table[own.key].by)
            for name, at in space.index.items():
                if name in own_slopes:
                    by[name] = own_slopes[name][own.key] - by_near[at, i] / space.std[at]
                elif name not in rests and here[at].any():
                    slope = here[at] / space.std[at]
                    by[name] = by[name] + slope if name in by else slope
            table[own.key] = replace(table[own.key], by=by)
    names = dict.fromkeys(name for own in table.values() for name in own.by)
    return Linearised(values={name: values[name] for name in names}, table=table)
