"""What follows the hits' level goes on to sharper lines beside what shows on broad ones.

The sharper the lines the more it brings: among the others it would be dropped.
"""

from __future__ import annotations

from collections.abc import Mapping

from armodal.analyzer.gap.fit import Fit, Stage
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.looks import goes_with, most_promising
from armodal.analyzer.gap.scan import scan_instances
from armodal.analyzer.gap.starts import WORTH_BROAD, first_steps

__all__ = ["promising_by_level"]


def promising_by_level(broad: Stage, base: Fit, start: Mapping[str, float]) -> list[Fit]:
    """Return a fit with the most promising effect that follows the level, after its first steps.

    None where soft and hard hits are not apart, where one is in the base already, or where none
    promises anything.
    """
    present = base.hypothesis
    if not present.ordinary.level_span or any(i.by_level for i in present.instances):
        return []
    instances = [i for i in all_instances(present.ordinary) if i.by_level]
    looked_at = scan_instances(broad, base, [i for i in instances if goes_with(i, present)])
    promising = most_promising(looked_at, WORTH_BROAD, each_kind=True)
    return first_steps(broad, base, promising, start)[:1]
