"""A long link that bends all along, both ways across its line."""

from __future__ import annotations

from armodal.analyzer.gap.effects.long_link import given_way
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.long_links import long_links
from armodal.analyzer.gap.model.ordinary import Ordinary

__all__ = ["WORDS", "instances"]

WORDS = EffectWords(
    name="link_bending",
    title="Link bends along its length",
    changes="hinges both ways across the link's line, its bending stiffness spread over them",
    signature="points along the link turn more the further out they sit, in two planes",
    confused_with=("link_axis", "bearing", "released_joint"),
    leaves_here=("link_axis", "bearing"),
    some_is_ordinary=True,
    told_by="points at three places along the link; hits along two directions across it",
    remedy="take the link as a beam: its section's bending stiffness over its length",
)
_MATERIAL = 0.012  # of its drive's compliance, root to tip


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """One for each long link."""
    return tuple(
        given_way(ordinary, line, WORDS, bends=True, word="bending", material=_MATERIAL)
        for line in long_links(ordinary.superset)
    )
