"""What effects of the hit's level share, and a look for any of them.

A joint whose torque is no linear function of its motion answers hits of one level nearly as a
spring and a damper do, others at another level (equivalent linearisation; Krylov and Bogoliubov,
Introduction to Non-Linear Mechanics (1947); Ewins, Modal Testing, 2nd ed. (2000), section 3.10).
With l the logarithm of the level from the middle of all,

    ln k(l) = ln k + a l ,    ln c(l) = ln c + b l .

That tells which joint, and whether the level tells anything. What it is only a law of its own
tells (`own_law.py`).
"""

from __future__ import annotations

from collections.abc import Mapping

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["COVERED", "COVERED_HERE", "LEAST", "any_change"]

# A hit of one level moves the joint more in one posture than in another: what changes with its
# motion changes with the posture, and effects that do so would be told of that.
COVERED = ("gravity_compensator", "load_damping", "nonproportional")
# While a swing dies away the joint's stiffness changes, which looks like a drive's freedom there.
COVERED_HERE = ("servo",)

# Of a joint's spring and of its damping, between the softest and the hardest hits: what changes
# less with the level is not worth a word.
LEAST, _LEAST_C = 0.02, 0.1
_STD_K, _STD_C = 0.3, 0.5  # a unit of ln level; a dry friction that is all of c has -1
_MOST_K, _MOST_C = 1.0, 2.0


def any_change(ordinary: Ordinary) -> tuple[Instance, ...]:
    """Stiffness and damping of each elastic joint by the level, either way: no effect, a look.

    None where soft and hard hits are not told apart.
    """
    if not ordinary.level_span:
        return ()
    words = EffectWords(name="level", title="Depends on the level", changes="", signature="")
    span = 2.0 * ordinary.level_span
    return tuple(_change(words, ordinary.arm.joints[i].name, span) for i in ordinary.elastic)


def _change(words: EffectWords, joint: str, span: float) -> Instance:
    by_k, by_c = f"ln k by level {joint}", f"ln c by level {joint}"

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        level = assembly.lines.level
        assembly.multiply_spring(joint, values, values[by_k] * level, values[by_c] * level)
        assembly.log_slopes[by_k] = (joint, level, 0.0)
        assembly.log_slopes[by_c] = (joint, 0.0, level)

    return Instance(
        effect=words,
        place=joint,
        parameters=(
            Parameter(name=by_k, unit="", mean=0.0, std=_STD_K, low=-_MOST_K, high=_MOST_K),
            Parameter(name=by_c, unit="", mean=0.0, std=_STD_C, low=-_MOST_C, high=_MOST_C),
        ),
        builder=build,
        size=by_k,
        material=LEAST / span,
        side_sizes=((by_c, _LEAST_C / span),),
        level_dependent=True,
    )
