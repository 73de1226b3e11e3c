"""What effects of the hit's level share: a joint's stiffness and damping that change with it.

A joint whose torque is no linear function of its motion answers hits of one level nearly as a
spring and a damper do, others at another level (equivalent linearisation; Krylov and Bogoliubov,
Introduction to Non-Linear Mechanics (1947); Ewins, Modal Testing, 2nd ed. (2000), section 3.10).
With l the logarithm of the level from the middle of all,

    ln k(l) = ln k + a l ,    ln c(l) = ln c + b l ,

and the signs of a and b name the kind. While a swing dies away a joint that softens sweeps through
its frequencies, which looks like damping: there b = -0.4 a without any loss (-0.8 to 0 in the
simulator); a seat that slips has b above -a until all of it slips, and less from there on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = [
    "COVERED",
    "COVERED_HERE",
    "LEAST_BY_C",
    "LEAST_BY_K",
    "Slope",
    "any_change",
    "level_instances",
]

# A hit of one level moves the joint more in one posture than in another: what changes with its
# motion changes with the posture, and effects that do so would be told of that.
COVERED = ("gravity_compensator", "load_damping", "nonproportional")
# While a swing dies away the joint's stiffness changes, which looks like a drive's freedom there.
COVERED_HERE = ("servo",)

LEAST_BY_K = 0.01  # per unit of ln level: 3 % of k from a hit to one twenty times as hard
LEAST_BY_C = 0.05
_REACH = 2.5  # times as far from the middle level as was measured: k there is the joint's too


@dataclass(frozen=True, slots=True, kw_only=True)
class Slope:
    """What ln k or ln c gains a unit of ln level: a Gaussian about zero, cut off."""

    sense: float  # -1: counted positive where it falls
    with_k: float = 0.0  # of ln c: beside what comes with each unit of the other
    std: float
    low: float
    high: float


def level_instances(
    ordinary: Ordinary, words: EffectWords, *, by_k: Slope, by_c: Slope, size: str, material: float
) -> tuple[Instance, ...]:
    """One for each elastic joint, where soft and hard hits are told apart.

    Parameters
    ----------
    by_k, by_c
        How ln k and ln c may change.
    size
        "k" or "c": which of both says how large it is.
    """
    if not ordinary.level_span:
        return ()
    found = []
    for i in ordinary.elastic:
        joint = ordinary.arm.joints[i].name
        slopes = {"k": by_k, "c": by_c}
        names = {
            what: f"{words.name} {what} {'falls' if slope.sense < 0.0 else 'grows'} {joint}"
            for what, slope in slopes.items()
        }

        def build(
            assembly: Assembly,
            values: Mapping[str, float],
            joint: str = joint,
            names: Mapping[str, str] = names,
            slopes: Mapping[str, Slope] = slopes,
        ) -> None:
            by_k_unit, by_c_unit = (slope.sense * assembly.lines.level for slope in slopes.values())
            c_with_k = slopes["c"].with_k * by_c_unit
            k, c = values[names["k"]], values[names["c"]]
            assembly.multiply_spring(joint, values, k * by_k_unit, c * by_c_unit + k * c_with_k)
            assembly.log_slopes[names["k"]] = (joint, by_k_unit, c_with_k)
            assembly.log_slopes[names["c"]] = (joint, 0.0, by_c_unit)

        parameters = tuple(
            Parameter(
                name=names[what], unit="", mean=0.0, std=slope.std, low=slope.low, high=slope.high
            )
            for what, slope in slopes.items()
        )
        found.append(
            Instance(
                effect=words,
                place=joint,
                parameters=parameters,
                builder=build,
                size=names[size],
                material=material,
                level_dependent=True,
                reaches={f"ln k {joint}": (names["k"], _REACH * ordinary.level_span)},
            )
        )
    return tuple(found)


def any_change(ordinary: Ordinary) -> tuple[Instance, ...]:
    """Stiffness and damping of each elastic joint by the level, either way: no effect, a look."""
    return level_instances(
        ordinary,
        EffectWords(name="level", title="Depends on the level", changes="", signature=""),
        by_k=Slope(sense=1.0, std=0.3, low=-1.0, high=1.0),
        by_c=Slope(sense=1.0, std=0.5, low=-2.0, high=2.0),
        size="k",
        material=0.0,
    )
