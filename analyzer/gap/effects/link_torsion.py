"""A long link that twists all along about its line."""

from __future__ import annotations

from armodal.analyzer.gap.effects.long_link import given_way
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.long_links import long_links
from armodal.analyzer.gap.model.ordinary import Ordinary

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="link_torsion",
    title="Link twists along its length",
    changes="hinges about the link's line, its torsional stiffness spread over them",
    signature="points along the link turn about its line, the more the further out they sit",
    confused_with=("link_axis", "released_joint"),
    leaves_here=("link_axis", "bearing"),
    some_is_ordinary=True,
    told_by="points off the line at three places along the link; a posture bent beyond it",
    remedy="take the link as a tube: its section's torsional stiffness over its length",
)
_MATERIAL = 0.03  # of its drive's compliance, root to tip


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each long link."""
    return tuple(
        given_way(ordinary, line, WORDS, bends=False, word="torsion", material=_MATERIAL)
        for line in long_links(ordinary.superset)
    )
