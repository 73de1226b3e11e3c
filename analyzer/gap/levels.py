"""Whether the response depends on the hit's level; only then soft and hard hits are kept apart.

The check of homogeneity without a model (`analyzer.checks.homogeneity`) sees modes move one
posture at a time. With a model every joint has one column in all postures, odd in the level, and
what ordinary errors leave is even in it: much smaller changes are seen.
"""

from __future__ import annotations

from collections.abc import Mapping

from analyzer.gap.effects import backlash, friction, microslip, softening
from analyzer.gap.fit import Stage, fit_hypothesis
from analyzer.gap.hypothesis import Hypothesis
from analyzer.gap.scan import scan_instances

__all__ = ["depends_on_level"]

_LEAST_GAIN = 12.0  # of cost by the linear look


def depends_on_level(
    broad: Stage, sharper: Stage, present: Hypothesis, start: Mapping[str, float]
) -> bool:
    """Whether a joint's stiffness or damping changes with the level beyond doubt worth a search.

    Parameters
    ----------
    broad, sharper
        Stages of lines of soft and of hard hits.
    present
        A hypothesis about levelled lines (`Ordinary.levelled`).
    """
    fit = fit_hypothesis(broad, present, start=start, max_iterations=7)
    fit = fit_hypothesis(sharper, present, start=fit.values, max_iterations=4)
    ordinary = present.ordinary
    instances = [
        instance
        for effect in (backlash, friction, microslip, softening)
        for instance in effect.instances(ordinary)
    ]
    taken = {instance.key for instance in present.instances}
    rest = [instance for instance in instances if instance.key not in taken]
    looked_at = scan_instances(sharper, fit, rest)
    return bool(looked_at) and looked_at[0].gain > _LEAST_GAIN
