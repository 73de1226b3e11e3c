"""A joint's bearing that gives way across the joint's axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.effects.compliance import bearing_loss, compliance_parameter
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="bearing",
    title="Bearing soft across its axis",
    changes="lets two rotations across the joint's axis give way, each by its own compliance",
    signature="the link beyond leans both ways across the joint's axis, about the joint",
    confused_with=("link_axis", "base"),
    told_by="points on both sides of the bearing; hits along two directions across the axis",
    remedy="check preload and bolts of the joint's main bearing",
)


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each joint: the null's small compliance without its limit."""
    found = []
    for link, joint in enumerate(ordinary.arm.joints):
        names = [f"bearing {side} {joint.name}" for side in "ab"]
        wide = compliance_parameter("", ordinary, link)
        relaxed: dict[str, Parameter] = {
            name: replace(wide, name=name, start=ordinary.bearing_limit(link)) for name in names
        }

        def alternatives(
            values: Mapping[str, float], link: int = link, names: Sequence[str] = tuple(names)
        ) -> Sequence[tuple[Instance, Mapping[str, float]]]:
            return _axes(ordinary, link, names, values)

        sides = across(np.asarray(joint.axis)).T.tolist()

        def describe(
            values: Mapping[str, float],
            name: str = joint.link.name,
            sides: list[list[float]] = sides,
        ) -> dict[str, object]:
            """Tilts are about two directions of the link's frame."""
            del values
            return {"link": name, "direction_a": sides[0], "direction_b": sides[1]}

        found.append(
            Instance(
                effect=WORDS,
                place=joint.name,
                is_term=True,
                describe=describe,
                relaxes=relaxed | bearing_loss(joint.name),
                alternatives=alternatives,
                size=names[0],
                sizes=tuple(names),
                words={
                    name: f"tilt stiffness about direction {side}"
                    for name, side in zip(names, "ab", strict=True)
                },
                material=ordinary.bearing_limit(link),
                drives=ordinary.drives(link),
            )
        )
    return tuple(found)


def _axes(
    ordinary: Ordinary, link: int, names: Sequence[str], values: Mapping[str, float]
) -> list[tuple[Instance, Mapping[str, float]]]:
    """A bearing that gives way one way rather than two may stand for an axis in the link beyond."""
    size = np.array([values[name] for name in names])
    if not size.any():
        return []
    turn = across(np.asarray(ordinary.arm.joints[link].axis))
    rest = {k: v for k, v in values.items() if k not in names}
    found: list[tuple[Instance, Mapping[str, float]]] = []
    for signs in ((1.0, 1.0), (1.0, -1.0)):
        direction = turn @ (np.sqrt(size) * signs)
        direction = direction / np.linalg.norm(direction)
        axis = link_axis.at_axis(ordinary, link, direction, np.zeros(3))
        found.append((axis, {**rest, axis.size: float(np.sum(size))}))
    return found
