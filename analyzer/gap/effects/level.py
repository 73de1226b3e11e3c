"""What effects of the hit's level share: a joint's stiffness and damping that change with it.

A joint whose torque is no linear function of its motion answers hits of one level nearly as a
spring and a damper do, others at another level (equivalent linearisation; Krylov and Bogoliubov,
Introduction to Non-Linear Mechanics (1947); Ewins, Modal Testing, 2nd ed. (2000), section 3.10).
With l the logarithm of the level from the middle of all,

    ln k(l) = ln k + a l ,    ln c(l) = ln c + b l ,

and the signs of a and b name the kind.
"""

from __future__ import annotations

from collections.abc import Mapping

from analyzer.gap.assembly import Assembly
from analyzer.gap.effects.effect import EffectWords, Instance
from analyzer.gap.ordinary import Ordinary
from analyzer.gap.space import Parameter

__all__ = ["Slope", "level_instances"]

Slope = tuple[float, float, float, float]  # mean, standard deviation, low, high


def level_instances(
    ordinary: Ordinary, words: EffectWords, *, by_k: Slope, by_c: Slope, size: str, material: float
) -> tuple[Instance, ...]:
    """One for each elastic joint, where soft and hard hits are told apart.

    Parameters
    ----------
    by_k, by_c
        What ln k and ln c may change per unit of ln level.
    size
        "k" or "c": which of both says how large it is.
    """
    if not ordinary.levelled:
        return ()
    found = []
    for i in ordinary.elastic:
        joint = ordinary.arm.joints[i].name
        names = {what: f"{words.name} {what} by level {joint}" for what in "kc"}

        def build(
            assembly: Assembly,
            values: Mapping[str, float],
            joint: str = joint,
            names: Mapping[str, str] = names,
        ) -> None:
            level = assembly.lines.level
            assembly.multiply_spring(
                joint, values, values[names["k"]] * level, values[names["c"]] * level
            )
            assembly.log_slopes[names["k"]] = (joint, level, 0.0)
            assembly.log_slopes[names["c"]] = (joint, 0.0, level)

        parameters = tuple(
            Parameter(name=names[what], mean=mean, std=std, low=low, high=high)
            for what, (mean, std, low, high) in (("k", by_k), ("c", by_c))
        )
        found.append(
            Instance(
                effect=words,
                place=joint,
                parameters=parameters,
                builder=build,
                size=names[size],
                material=material,
            )
        )
    return tuple(found)
