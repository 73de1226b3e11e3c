"""The verdict: named, ambiguous, nothing detectable, or outside the library.

Three rules, all needed (each alone gave wrong names): a rival is named when the evidence for it is
clear and no other stands beside it, when it is large enough to matter, and when postures it was
not fitted to are foretold better with it. And whatever was named, a misfit far above what ordinary
errors leave says that something is missing which the library does not know.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import zip_longest

import numpy as np

from armodal.analyzer.gap.decision.shared import is_shared
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.inference.misfit import misfit_per_line
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.protocols.arm.records import Joint

__all__ = [
    "SURELY_BY_LEVEL",
    "Judged",
    "Thresholds",
    "ends_alike",
    "follows_no_level",
    "is_as_good",
    "is_certain",
    "judge",
    "one_mechanism",
    "outside_misfit",
    "scale",
]


_LIKELIER, _PART_OF_GAIN = 3.0, 0.1
_MUCH_ELSE = 3.0  # times the ordinary misfit
# What one joint's stiffness and damping at each level do not tell looks like another such joint.
_LEVEL_AGAIN = 3.0
# Nats: six nulls had 5 at most and an uncorrected window 12.3; of eight cracks five had 69 to 354,
# three no more than 8 to 14.
SURELY_BY_LEVEL = 40.0
_SLIGHT_PART = 0.02  # of a gain
_TEMPERED = 10.0  # nats that tell as one would if the models had no errors in common


@dataclass(frozen=True, slots=True, kw_only=True)
class Thresholds:
    """Calibrated on seeds that no study uses (`docs/theory-gap.md`)."""

    clear: float = 100.0  # nats of evidence over the present hypothesis
    apart: float = 20.0  # nats to the next rival
    ordinary_misfit: float = 0.60  # chi^2 per real residual that ordinary errors leave at most
    misread: float = 45.0  # nats for axes exchanged or turned round: nothing to tune
    relaxed: float = 25.0  # nats for an ordinary error beyond its tolerance: no new term
    outside_misfit: float = 0.80  # above this something is missing
    # Likewise where soft and hard hits are apart and no name follows the level: of 600 sealed cases
    # the right ones without such a name left 0.63 at most, a null 0.70, a crack named an axis 0.79.
    unfollowed_misfit: float = 0.75
    # At least, where the variance allows for hits of unequal levels: true models leave 0.37.
    outside_widened: float = 0.50
    # Of the response, in a posture fitted to: where soft and hard hits are apart their difference
    # counts as scatter, and no misfit tells of what only that explains. True models leave 0.09.
    outside_left: float = 0.20
    # Nats of what is too small to matter: then it is not that. And of what is large, but of
    # uncertain size: then it is no patch.
    unplaced: float = 1000.0
    # Likewise beside a name: of 260 right ones of sealed cases none left more than 202.
    beside_name: float = 250.0
    # Wanted of another effect beside one that follows the level: right ones leave 207 at most.
    beside_level: float = 250.0
    held_out: float = 3.0  # nats that held-out postures must gain together


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """Which rivals stand after one step; the first is the best."""

    named: Fit | None
    standing: tuple[Fit, ...]  # ambiguous with each other where more than one
    phi: float  # allowance beyond the assumed discrepancy, estimated
    doubted: bool = False  # the first fits better, but held-out postures speak against it
    confidence: float = 1.0  # of what is named: by its evidence over that of others, tempered


def outside_misfit(stage: Stage, thresholds: Thresholds) -> float:
    """Misfit a residual above which something is missing."""
    widened = max(lines.widened for lines in stage.lines)
    least = thresholds.outside_widened
    return max(thresholds.outside_misfit / float(np.sqrt(widened)), least)


def scale(stage: Stage, fits: Sequence[Fit], thresholds: Thresholds) -> float:
    """Factor by which evidence counts less: what the best fit leaves over ordinary misfit."""
    best = min(misfit_per_line(stage, f) for f in fits)
    return max(1.0, best / thresholds.ordinary_misfit)


def judge(stage: Stage, present: Fit, rivals: Sequence[Fit], thresholds: Thresholds) -> Judged:
    """Judge the rivals of one step.

    Parameters
    ----------
    rivals
        Best evidence first, each the present hypothesis and one effect more.
    """
    phi = scale(stage, [present, *rivals], thresholds)
    better = [r for r in rivals if present.evidence - r.evidence > _wanted(r, thresholds) * phi]
    if not better:
        return Judged(named=None, standing=(), phi=phi)
    beyond_doubt = thresholds.unplaced * phi
    material = [
        r
        for r in better
        if r.last.is_material(r.values)
        and (
            present.evidence - r.evidence > beyond_doubt
            or (is_certain(r) and is_shared(stage, present, r))
        )
    ]
    if not material:
        return Judged(named=None, standing=(), phi=phi)
    best = _plainest(material, present, thresholds.apart, phi)
    # Also what is too small to matter must be beaten: else it may be that, and not the best.
    beside = [
        r
        for r in rivals
        if r is not best
        and r.evidence - best.evidence < thresholds.apart * phi
        and not _same(best, r)
        and not _at_an_end(r, best, phi)
        and not _is_no_more_than(r, best, thresholds.apart * phi)
    ]
    if beside and present.evidence - best.evidence < _clear(best, thresholds) * phi:
        # So little, and for several alike: what ordinary errors leave, not an error beyond them.
        return Judged(named=None, standing=(), phi=phi)
    if beside:
        return Judged(named=None, standing=(best, *beside), phi=phi)
    others = [r for r in rivals if r is not best and not _same(best, r)]
    others = [r for r in others if r.evidence > best.evidence]
    behind = np.array([r.evidence - best.evidence for r in (present, *others)])
    odds = float(np.sum(np.exp(-behind / (_TEMPERED * phi))))
    return Judged(named=best, standing=(best,), phi=phi, confidence=1.0 / (1.0 + odds))


def _plainest(material: Sequence[Fit], present: Fit, apart: float, phi: float) -> Fit:
    """The best; where that is an axis, the released joint on which it lies.

    Or the bearing at an end of its link while much else is missing: what the axis, with three
    parameters more, is better by then, is of that.
    """
    best = material[0]
    gain = present.evidence - best.evidence
    near = (
        r
        for r in material
        if (_is_also(best, r) and is_as_good(r.evidence - best.evidence, gain, apart * phi))
        or (_at_an_end(best, r, phi) and r.evidence - best.evidence < _SLIGHT_PART * gain)
    )
    return next(near, best)


def is_as_good(behind: float, gain: float, apart: float) -> bool:
    """Whether a joint believed rigid, released, is the likelier name than an axis in its link.

    Parameters
    ----------
    behind
        Nats by which the axis, with three parameters more, is better.
    gain
        Nats that the axis brings.
    apart
        Nats by which rivals are told apart.
    """
    return behind < min(_LIKELIER * apart, _PART_OF_GAIN * gain)


def is_certain(fit: Fit) -> bool:
    """Whether the last effect's size is known well enough to be more than a patch."""
    added = fit.last
    if not added.least_certain:
        return True
    i = fit.space.index[added.size]
    std = float(fit.space.std[i] * np.sqrt(fit.covariance()[i, i]))
    return fit.values[added.size] >= added.least_certain * std


def one_mechanism(
    instances: Sequence[Instance], joints: Sequence[Joint]
) -> tuple[Instance, Instance] | None:
    """Two effects at one joint that together are what one unknown mechanism would look like.

    What is inside a link is at both joints of it.
    """

    def places(instance: Instance) -> set[str]:
        found = set(instance.place.split(" and "))
        for joint, beyond in zip_longest(joints, joints[1:]):
            if joint.link.name in found:
                found |= {joint.name} | ({beyond.name} if beyond else set())
        return found

    for one in instances:
        for other in instances:
            if other.effect.name in one.effect.one_with and places(one) & places(other):
                return one, other
    return None


def follows_no_level(hypothesis: Hypothesis) -> bool:
    """Whether the hits' level surely tells something, and no effect follows it."""
    return hypothesis.ordinary.level_gain > SURELY_BY_LEVEL and not hypothesis.by_level


def _wanted(fit: Fit, thresholds: Thresholds) -> float:
    added = fit.last
    if added.adds_term:
        return _clear(fit, thresholds)
    return thresholds.relaxed if added.relaxes else thresholds.misread


def _clear(fit: Fit, thresholds: Thresholds) -> float:
    """Nats that an added effect needs to be named.

    More beside one that follows the hits' level, which a spring and a damper at each level are
    only nearly; and none needs less than usual where soft and hard hits are apart.
    """
    *others, added = fit.hypothesis.instances
    if any(other.by_level for other in others):
        return _LEVEL_AGAIN * thresholds.clear if added.by_level else thresholds.beside_level
    if added.effect.wanted is None or fit.hypothesis.ordinary.level_span:
        return thresholds.clear
    return added.effect.wanted


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


def _is_no_more_than(rival: Fit, best: Fit, apart: float) -> bool:
    """Whether a rival holds the best inside it, and nothing else that matters or is told."""
    a, b = rival.last, best.last
    inside = b.effect.name in a.effect.contains and b.place in a.place.split(" and ")
    told = best.evidence - rival.evidence > apart
    return inside and not told and not a.is_material(rival.values)


def _at_an_end(inside: Fit, end: Fit, phi: float) -> bool:
    """Whether one is at an end of the other, where it patches it, and much else is missing."""
    return phi > _MUCH_ELSE and end.last.key in inside.last.at_its_ends


def _is_also(one: Fit, other: Fit) -> bool:
    """Whether by the values of one the other is the same thing, told better."""
    is_also = one.last.is_also
    return is_also is not None and is_also(one.values, other.last)
