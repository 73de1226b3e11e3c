"""What laws of joints share: a joint's torque as a function of its turn, and what it remembers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.geometry import PostureGeometry
from armodal.analyzer.gap.model.gravity_load import gravity_load
from armodal.analyzer.gap.model.joint_laws import ElementOf, JointLaw
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter
from armodal.protocols.plan_records import KnownMass

__all__ = ["law_instance", "law_of_file"]

LawMaker = Callable[[Ordinary, str, float, float], tuple[Instance, ...]]


def law_instance(
    ordinary: Ordinary,
    words: EffectWords,
    joint: str,
    swing_rad: float,
    rate_rad_s: float,
    *,
    parameters: Sequence[Parameter],
    element: ElementOf,
    material: float,
    starting_points: Sequence[Mapping[str, float]],
    words_of_it: Mapping[str, str] | None = None,
) -> Instance:
    """Return a law at one joint; the first parameter is its size.

    Parameters
    ----------
    swing_rad, rate_rad_s
        Of a hit of the middle level, where it moves the joint most: its turn, and its rate over it.
    starting_points
        Values of its parameters where fits begin.
    words_of_it
        Entries of its description that tell it from others of its kind there.
    """
    at = [own.name for own in ordinary.arm.joints].index(joint)
    links = tuple(own.link for own in ordinary.arm.joints)
    column = ordinary.superset.joint_column(at)

    def load(geometry: PostureGeometry, bolted_on: KnownMass | None) -> float:
        return gravity_load(geometry, links, column, bolted_on)

    def initial(values: Mapping[str, float]) -> list[Mapping[str, float]]:
        return [{**values, **start} for start in starting_points]

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        del values
        told = {"joint": joint, "swing_rad": swing_rad, "rate_rad_s": rate_rad_s}
        return {**told, **(words_of_it or {})}

    size, *shapes = (parameter.name for parameter in parameters)
    return Instance(
        effect=words,
        place=joint,
        parameters=tuple(parameters),
        describe=describe,
        initial_values=initial,
        size=size,
        shapes=tuple(shapes),
        material=material,
        level_dependent=True,
        law=JointLaw(
            joint=joint,
            element=element,
            swing_rad=swing_rad,
            rate_rad_s=rate_rad_s,
            load_n_m=load,
        ),
    )


def law_of_file(
    laws: LawMaker, ordinary: Ordinary, description: Mapping[str, object]
) -> Instance | None:
    """Return the law that an arm file describes; None where it does not."""
    joint, swing, rate = (description.get(key) for key in ("joint", "swing_rad", "rate_rad_s"))
    known = {ordinary.arm.joints[i].name for i in ordinary.elastic}
    if not isinstance(swing, float) or not isinstance(rate, float) or joint not in known:
        return None
    every = laws(ordinary, str(joint), swing, rate)
    told = (law.describe({}) if law.describe else {} for law in every)
    alike = [
        law for law, own in zip(every, told, strict=True) if own.items() <= description.items()
    ]
    return next(iter(alike), every[0])
