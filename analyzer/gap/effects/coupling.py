"""Two joints that pull on each other."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="coupling",
    title="Two joints are coupled",
    changes="stiffness and damping between two joints; k of each is then that with the other held",
    signature="a hit on one joint's freedom moves the other more than inertia explains",
    confused_with=("wrist_coupling", "link_axis"),
    one_with=("gravity_compensator",),
    one_such_as="a bar across both joints",
    told_by="a posture in which the mass matrix does not couple the two",
    remedy="look for belts, a parallelogram, cables or a common gear between the two joints",
)
_MATERIAL = 0.02  # of the geometric mean of both stiffnesses
_STD, _LOSS_STD = 0.3, 1.0  # of that, and of the mean of both dampings


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """Every two elastic joints that are neighbours, or have one between them."""
    found = []
    for position, i in enumerate(ordinary.elastic):
        for j in ordinary.elastic[position + 1 : position + 3]:
            a, b = ordinary.arm.joints[i].name, ordinary.arm.joints[j].name
            stiff, lossy = f"coupling {a} {b}", f"coupling loss {a} {b}"

            # Relative to what the arm file believes, so that a term does not move with k itself.
            k, c = (_mean(ordinary, i, j, what) for what in ("stiffness", "damping"))

            def build(
                assembly: Assembly,
                values: Mapping[str, float],
                a: str = a,
                b: str = b,
                stiff: str = stiff,
                lossy: str = lossy,
                k: float = k,
                c: float = c,
            ) -> None:
                at_a, at_b = assembly.names[a], assembly.names[b]
                assembly.add_term(
                    "stiffness", at_a, at_b, values[stiff] * k, parameter=stiff, slope=k
                )
                assembly.add_term(
                    "damping", at_a, at_b, values[lossy] * c, parameter=lossy, slope=c
                )

            found.append(
                Instance(
                    effect=WORDS,
                    place=f"{a} and {b}",
                    parameters=(
                        Parameter(name=stiff, unit="", mean=0.0, std=_STD),
                        Parameter(name=lossy, unit="", mean=0.0, std=_LOSS_STD),
                    ),
                    builder=build,
                    words={
                        stiff: "stiffness between them, over √(k k) of the arm file",
                        lossy: "damping between them, over √(c c) of the arm file",
                    },
                    size=stiff,
                    material=_MATERIAL,
                )
            )
    return tuple(found)


def _mean(ordinary: Ordinary, i: int, j: int, what: str) -> float:
    """Geometric mean of what the arm file believes of two joints."""
    believed = [getattr(ordinary.arm.joints[joint], what) for joint in (i, j)]
    return float(np.sqrt(np.prod([1.0 if e is None else e.value for e in believed])))
