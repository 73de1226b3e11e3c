"""Gears of a wrist: a drive runs through the joint before it, whose turn winds it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from armodal.analyzer.gap.effects.compliance import bearing_loss, compliance_parameter
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="wrist_coupling",
    title="Wrist gears couple two joints",
    changes="the driven link turns back by a ratio of what the driving joint's spring gives way",
    signature="where the joint before gives way, the last link turns about its own axis with it",
    confused_with=("coupling", "released_joint"),
    contains=("released_joint",),  # the driven drive's own spring
    told_by="a point off the last axis on the last link; postures that turn the last joint",
    remedy="compare with the maker's ratio of the wrist's gears; the new arm file has this one",
)
_MATERIAL = 0.05
_STD = 1.0


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """Every joint without a spring whose drive can run through an elastic one before it."""
    joints = ordinary.arm.joints
    return tuple(
        _through(ordinary, i - 1, i)
        for i in range(1, len(joints))
        if joints[i].stiffness is None and joints[i - 1].stiffness is not None
    )


def _through(ordinary: Ordinary, driver: int, driven: int) -> Instance:
    """With x the driver's turn the driven link turns by -ratio x, and beside by its own spring.

    Two joints with springs are a coupling: the same terms of K.
    """
    a, b = ordinary.arm.joints[driver].name, ordinary.arm.joints[driven].name
    name, own = f"wrist ratio {a} {b}", f"compliance of {b}"
    column = ordinary.superset.joint_column(driven)

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        at = assembly.names[a]
        turned = assembly.unit(column)
        assembly.columns[at] = assembly.columns[at] - values[name] * turned
        assembly.motion_of[name] = [(at, -turned)]

    def alternatives(
        values: Mapping[str, float],
    ) -> Sequence[tuple[Instance, Mapping[str, float]]]:
        """Without a ratio it is the driven joint that gives way."""
        rest = {k: v for k, v in values.items() if k != name}
        return [(i, rest) for i in all_instances(ordinary) if i.key == ("released_joint", b)]

    return Instance(
        effect=WORDS,
        place=f"{a} and {b}",
        parameters=(Parameter(name=name, unit="", mean=0.0, std=_STD),),
        relaxes={own: compliance_parameter(own, ordinary, driven), **bearing_loss(b)},
        builder=build,
        alternatives=alternatives,
        size=name,
        material=_MATERIAL,
    )
