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
    models: Sequence[PosedModel],
    lines: Sequence[PostureLines],
    values: Mapping[str, float],
    by_torque: Mapping[str, ComplexArray],
    followed: Sequence[tuple[Array, Array]],
) -> Linearised:
    """Return it with what all other parameters change in what springs and dampers leave.

    A compliance that rests at none is left out: the torque's way through it is not solved for.

    Parameters
    ----------
    about
        Exact at a point.
    plain, law, values
        The model without the law, the law, and the point.
    models, lines
        Of each posture and level.
    by_torque
        The joint's turn by a unit torque in each posture, by its name (`swings.Swings`).
    followed
        Turns and torques (1 or more, n_hits, n_steps) on each of the lines, first those there.
    """
    springs = {key: (own.log_k, own.log_c) for key, own in about.table.items()}
    near = with_springs(plain, law.joint, springs)
    space = plain.space()
    table = dict(about.table)
    counts = [len(turn[0]) for turn, _ in followed]
    geometries = [model.geometry(plain.ordinary, values) for model in models]
    every = [law.element(values, law.load_n_m(geometry)) for geometry in geometries]
    tangents = tangents_along(
        stacked(every, counts),
        np.concatenate([turn[0] for turn, _ in followed]),
        [*by_torque.values()],
    )
    ends = np.cumsum(counts)
    for model, own, (_, torque), end in zip(models, lines, followed, ends, strict=True):
        together = Postures([model], [own])
        assembly = together.assembled(plain, values)[0]
        row = joint_row(assembly, law.joint)
        changes = torque_slopes(
            together,
            plain,
            space,
            values,
            row,
            by_torque[own.name],
            tangents.of(slice(end - len(torque[0]), end)),
            torque[0],
        )
        load = together.response(plain, values).under_a_torque(row[None])[0]
        held = on_lines(own, torque[0])[own.hit]
        slopes = together.derivatives_holding_back(plain, space, values, row[None], held[None])
        slopes = slopes[:, 0] - load * changes[:, own.hit][:, :, None]
        _, in_its_place = together.derivatives(near, space, values)
        slopes -= in_its_place[:, 0]
        rests = {name for name in assembly.compliance_of if values[name] == 0.0}
        here = table[own.key]
        by = dict(here.by)
        for name, i in space.index.items():
            if name not in rests and slopes[i].any():
                slope = slopes[i] / space.std[i]
                by[name] = by[name] + slope if name in by else slope
        table[own.key] = replace(here, by=by)
    names = dict.fromkeys(name for own in table.values() for name in own.by)
    return Linearised(values={name: values[name] for name in names}, table=table)
