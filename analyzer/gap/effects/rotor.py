"""A drive's rotor that turns with its joint: inertia reflected through the gear."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from armodal.analyzer.arm.reduced import reduce_model
from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "carried_moment", "instances"]

WORDS = EffectWords(
    name="rotor",
    title="Motor's rotor inertia at a joint",
    changes="adds to the joint's own diagonal of M, and to nothing else",
    signature="the joint's mode falls in every posture by the same inertia, whatever is beyond",
    confused_with=("servo", "payload"),
    told_by="a posture in which the joint carries little inertia; brakes on against servo",
    remedy="compare with ratio squared times the rotor; the new arm file has it: use that",
)
_MATERIAL_KG_M2 = 0.05
_STD, _MATERIAL = 0.3, 0.01  # of the carried moment
_POSTURES = 12


def carried_moment(ordinary: Ordinary, joint: int) -> float:
    """Return the moment of inertia about an elastic joint, all links beyond it held, kg m^2.

    The largest of some postures: what a motor and gear are chosen for.
    """
    return dict(_carried(ordinary.superset))[joint]


@lru_cache(maxsize=16)
def _carried(superset: Superset) -> tuple[tuple[int, float], ...]:
    structure = believed_structure(superset.arm)
    low, high = np.array([joint.range_rad for joint in superset.arm.joints]).T
    rng = np.random.default_rng(0)
    diagonals = [
        reduce_model(superset, superset.posture(q), structure).mass.diagonal()
        for q in low + (high - low) * rng.random((_POSTURES, len(low)))
    ]
    largest = np.max(diagonals, axis=0)[: len(structure.joints)]
    return tuple(zip(structure.joints, largest.tolist(), strict=True))


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each elastic joint."""
    found = []
    for i in ordinary.elastic:
        joint = ordinary.arm.joints[i].name
        name = f"rotor {joint}"

        def build(
            assembly: Assembly,
            values: Mapping[str, float],
            joint: str = joint,
            name: str = name,
        ) -> None:
            at = assembly.names[joint]
            assembly.add_term("mass", at, at, values[name], parameter=name)

        found.append(
            Instance(
                effect=WORDS,
                place=joint,
                parameters=(
                    Parameter(
                        name=name,
                        unit="kg m²",
                        mean=0.0,
                        std=_STD * carried_moment(ordinary, i),
                        low=0.0,
                    ),
                ),
                builder=build,
                size=name,
                material=min(_MATERIAL_KG_M2, _MATERIAL * carried_moment(ordinary, i)),
            )
        )
    return tuple(found)
