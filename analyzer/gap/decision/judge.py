"""Which rivals stand after one step, and which of them has a name.

It has one when the evidence for it is clear and no other stands beside it, when it is large enough
to matter (`naming.py`), and when postures are foretold better from each other with it. What a
misfit far above what ordinary errors leave says is for the verdict (`verdict.py`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import permutations, zip_longest

from armodal.analyzer.gap.decision.calibration import Calibration
from armodal.analyzer.gap.decision.matters import is_material, matters
from armodal.analyzer.gap.decision.mounting_share import is_shared
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.protocols.arm.records import Joint

__all__ = [
    "Judged",
    "ends_alike",
    "is_plainer",
    "judge",
    "one_mechanism",
]


_PART_OF_GAIN = 0.1  # by which an axis may explain more than the joint on which it lies


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """Which rivals stand after one step; the first is the best."""

    named: Fit | None
    standing: tuple[Fit, ...]  # ambiguous with each other where more than one
    phi: float  # of the data's variance: what errors are worth over independent ones
    calibration: Calibration
    doubted: bool = False  # the first fits better, but postures or its misfit speak against it
    confidence: float = 1.0  # of what is named: by its evidence over that of others, tempered


def judge(
    stage: Stage,
    present: Fit,
    rivals: Sequence[Fit],
    calibration: Calibration,
) -> Judged:
    """Judge the rivals of one step.

    Parameters
    ----------
    rivals
        Best evidence first, each the present hypothesis and one effect more.
    calibration
        Their limits, by replicas of the session.
    """
    phi, apart = calibration.inflation, calibration.apart
    nothing = Judged(named=None, standing=(), phi=phi, calibration=calibration)
    clear = [
        r
        for r in rivals
        if present.evidence - r.evidence > calibration.limit(r.last.effect.name)
        and is_shared(stage, present, r)
    ]
    # What is far behind has no name for being larger, but may leave it open.
    leading = [r for r in clear if r.evidence - clear[0].evidence < apart]
    large = partial(_large, stage, present, clear, phi)
    material = large(leading) or large(clear)
    if not material:
        return nothing
    best = _plainest(material[0], large(clear), present)
    # Also what is too small to matter must be beaten: else it may be that, and not the best.
    beside = [
        r
        for r in rivals
        if r is not best
        and r.evidence - best.evidence < apart
        and not _same(best, r)
        and not _is_no_more_than(stage, r, best, apart, phi)
    ]
    if beside:
        return replace(nothing, standing=(best, *beside))
    others = [r for r in rivals if r is not best and not _same(best, r)]
    others = [r for r in others if r.evidence > best.evidence]
    odds = sum(calibration.odds(r.evidence - best.evidence) for r in (present, *others))
    return replace(nothing, named=best, standing=(best,), confidence=1.0 / (1.0 + odds))


def _large(
    stage: Stage, present: Fit, clear: Sequence[Fit], phi: float, some: Sequence[Fit]
) -> list[Fit]:
    """Of some that are clear those large enough, or else those that are most of what is missing.

    What holds another inside it takes off what that does: most must be missing beside that.
    """
    large = [r for r in some if is_material(stage, r, r.last, phi)]
    return large or [
        r for r in some if matters(stage, _inside(r, clear) or present, r, r.last, phi)
    ]


def _inside(rival: Fit, others: Sequence[Fit]) -> Fit | None:
    """The rival that another holds inside it, at one of its places."""
    a = rival.last
    return next((r for r in others if _contains(a, r.last)), None)


def _contains(one: Instance, other: Instance) -> bool:
    return other.effect.name in one.effect.contains and other.place in one.place.split(" and ")


def _plainest(best: Fit, large: Sequence[Fit], present: Fit) -> Fit:
    """The best; where that is an axis, the released joint on which it lies."""
    return next((r for r in large if is_plainer(r, best, present)), best)


def is_plainer(joint: Fit, axis: Fit, present: Fit) -> bool:
    """Whether a joint believed rigid, released, is the likelier name than an axis that lies on it.

    A line in the link that happens to lie there is rare. What its four parameters of place explain
    besides, where most is explained, are errors of the right model; they grow with what was
    missing, which `present` has not.
    """
    gain = present.evidence - axis.evidence
    if joint.last.effect is axis.last.effect:
        return False  # at two places, and the better has the name
    return _is_also(axis, joint) and joint.evidence - axis.evidence < _PART_OF_GAIN * gain


def one_mechanism(
    instances: Sequence[Instance], joints: Sequence[Joint]
) -> tuple[Instance, Instance] | None:
    """Two effects at one joint that together are what one unknown mechanism would look like.

    What is inside a link is at both joints of it. Two of one effect that is `one_with` itself are
    one wherever they stand: it hangs from link to link.
    """

    def places(instance: Instance) -> set[str]:
        found = set(instance.place.split(" and "))
        for joint, beyond in zip_longest(joints, joints[1:]):
            if joint.link.name in found:
                found |= {joint.name} | ({beyond.name} if beyond else set())
        return found

    for one, other in permutations(instances, 2):
        near = one.effect is other.effect or places(one) & places(other)
        if near and other.effect.name in one.effect.one_with:
            return one, other
    return None


def _same(one: Fit, other: Fit) -> bool:
    a, b = one.last, other.last
    if a.key == b.key or _is_also(one, other) or _is_also(other, one):
        return True
    return ends_alike(a, b)


def ends_alike(one: Instance, other: Instance) -> bool:
    """Whether two instances of one effect differ in where they begin, which tells too little."""
    if one.effect is not other.effect or not one.effect.ends_alike:
        return False
    return one.place.split(" and ")[-1] == other.place.split(" and ")[-1]


def _is_no_more_than(stage: Stage, rival: Fit, best: Fit, apart: float, phi: float) -> bool:
    """Whether a rival holds the best inside it, and nothing else that matters or is told."""
    told = best.evidence - rival.evidence > apart
    inside = _contains(rival.last, best.last)
    return inside and not told and not is_material(stage, rival, rival.last, phi)


def _is_also(one: Fit, other: Fit) -> bool:
    """Whether by the values of one the other is the same thing, told better."""
    is_also = one.last.is_also
    return is_also is not None and is_also(one.values, other.last)
