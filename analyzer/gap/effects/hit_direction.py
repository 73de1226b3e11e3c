"""Hits along another direction than the one written down."""

from __future__ import annotations

from collections.abc import Mapping

import scipy

from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="hit_direction",
    of_the_test=True,
    title="Hits along another direction",
    changes="the direction of the force: one turn common to all postures, or that of one posture",
    signature="modes are excited in other shares than the direction written down would",
    confused_with=("encoder_offset", "hammer_gain", "wrong_point"),
    # All aims off alike: ordinary errors beyond their tolerance rather than a term. Of 1178 nulls
    # none had a turn that was worth a fit.
    told_by="hits along a surface normal, or with a guide that holds the hammer",
    remedy="measure the hits' direction, correct it in the plan, and hit again",
)
_TURN_STD, _MATERIAL = 0.2, 0.035  # rad


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """All hits turned alike, or those of one posture.

    Where one point is hit, a posture's hits have but two angles, which the null has as their aim.
    """
    postures = ordinary.postures
    if ordinary.one_is_hit:
        return (_turned(None), *(_aimed(posture) for posture in postures))
    return (_turned(None), *(_turned(posture) for posture in postures))


def _turned(posture: str | None) -> Instance:
    """Hits turned about base axes, of one posture or (None) of all."""
    of = "" if posture is None else f" {posture}"
    turns = [f"hit turn {axis}{of}" for axis in "xyz"]

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        if posture is None or assembly.lines.name == posture:
            turn = scipy.spatial.transform.Rotation.from_rotvec(
                [values[name] for name in turns]
            ).as_matrix()
            assembly.hit_turn = turn @ assembly.hit_turn

    return Instance(
        effect=WORDS,
        place="hammer" if posture is None else f"posture {posture}",
        parameters=tuple(
            Parameter(name=name, unit="rad", mean=0.0, std=_TURN_STD) for name in turns
        ),
        builder=build,
        size=turns[0],
        sizes=tuple(turns),
        material=_MATERIAL,
        of_one_posture=posture is not None,
    )


def _aimed(posture: str) -> Instance:
    """The aim of one posture's hits, beyond its tolerance."""
    names = [f"aim {side} {posture}" for side in "ab"]
    return Instance(
        effect=WORDS,
        place=f"posture {posture}",
        relaxes={n: Parameter(name=n, unit="rad", mean=0.0, std=_TURN_STD) for n in names},
        size=names[0],
        sizes=tuple(names),
        material=_MATERIAL,
        of_one_posture=True,
    )
