"""Soft and hard hits at the same point, and what one hit that outweighs the others leaves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from armodal.protocols.session.records import Hit, Session

__all__ = [
    "has_hits_between",
    "has_levels",
    "middle_level",
    "postures_hit_once",
    "soft_and_hard",
    "weight_factors",
]

_LEAST_RATIO = 1.5  # of peak forces, to be two levels
_TWO = 2  # levels
_BETWEEN = 0.25  # of the way between both, from either, to be a level of its own


def has_levels(session: Session) -> bool:
    """Whether every point was hit clearly harder and clearly softer in every posture."""
    soft, hard = soft_and_hard([hit for hit in session.hits if hit.verdict.accepted])
    if not soft or len(soft) != len(hard):
        return False
    ratios = [h.verdict.peak_n / s.verdict.peak_n for s, h in zip(soft, hard, strict=True)]
    return min(ratios) > _LEAST_RATIO


def has_hits_between(session: Session) -> bool:
    """Whether every point was also hit clearly between softly and hard."""
    groups = _at_levels([hit for hit in session.hits if hit.verdict.accepted])
    return has_levels(session) and len(groups) > _TWO


def middle_level(session: Session) -> float:
    """Return ln of the peak force in N between soft and hard hits, where both are."""
    both = soft_and_hard([hit for hit in session.hits if hit.verdict.accepted])
    return float(np.mean([[np.log(hit.verdict.peak_n) for hit in hits] for hits in both]))


def soft_and_hard(hits: Sequence[Hit]) -> tuple[list[Hit], list[Hit]]:
    """The softest and the hardest third, at least one, of the hits at each point."""
    soft, _, hard = _thirds(hits)
    return soft, hard


def _at_levels(hits: Sequence[Hit]) -> tuple[list[Hit], ...]:
    """Soft hits, those between where every point has one clearly between, and hard hits."""
    soft, between, hard = _thirds(hits)
    points = {_place(hit) for hit in soft}
    if not between or {_place(hit) for hit in between} != points:
        return soft, hard
    low, middle, high = (
        float(np.mean([np.log(hit.verdict.peak_n) for hit in own])) for own in (soft, between, hard)
    )
    part = (middle - low) / (high - low)
    return (soft, between, hard) if _BETWEEN < part < 1.0 - _BETWEEN else (soft, hard)


def _place(hit: Hit) -> tuple[object, ...]:
    direction = tuple(np.round(hit.hit_direction, 6).tolist())
    return hit.posture, hit.sensor_point, hit.hit_point, direction


def _thirds(hits: Sequence[Hit]) -> tuple[list[Hit], list[Hit], list[Hit]]:
    """By peak force at each point; none at all where a point was hit once."""
    groups: dict[tuple[object, ...], list[Hit]] = {}
    for hit in hits:
        groups.setdefault(_place(hit), []).append(hit)
    soft: list[Hit] = []
    between: list[Hit] = []
    hard: list[Hit] = []
    for group in groups.values():
        group.sort(key=lambda hit: hit.verdict.peak_n)
        n = max(len(group) // 3, 1)
        if len(group) < 2 * n:
            return [], [], []
        soft += group[:n]
        between += group[n:-n]
        hard += group[-n:]
    return soft, between, hard


def postures_hit_once(hits: Sequence[Hit]) -> tuple[str, ...]:
    """Return the postures where most points were hit once: little there tells how hits scatter.

    Where fewer were, the scatter of the others is taken.
    """
    times: dict[str, list[int]] = {}
    for (posture, *_), n in Counter(_place(hit) for hit in hits).items():
        times.setdefault(str(posture), []).append(n)
    return tuple(name for name, own in times.items() if 2 * own.count(1) > len(own))


def weight_factors(hits: Sequence[Hit]) -> dict[tuple[str, str, str], float]:
    """Factor of the variance of an average of hits, by posture, sensor point and hit point.

    With weights w by force power (sums to 1) relative errors of single hits scatter by 1 - sum w^2
    about the mean and leave sum w^2 in it; the estimate from scatter takes all hits to be alike.
    """
    forces: dict[tuple[str, str, str], list[float]] = {}
    for hit in hits:
        key = hit.posture, hit.sensor_point, hit.hit_point
        forces.setdefault(key, []).append(hit.verdict.peak_n)
    found = {}
    for key, peaks in forces.items():
        power = np.array(peaks) ** 2
        left = float(np.sum((power / power.sum()) ** 2))
        alike = len(peaks) - 1
        found[key] = max(alike * left / (1.0 - left), 1.0) if alike else 1.0
    return found
