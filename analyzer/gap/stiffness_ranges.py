"""Every joint's stiffness as a range: of all models that stand, and of what nobody would see."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from armodal.analyzer.confidence import ONE_SIDED_95, TWO_SIDED_95
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.inference.intervals import intervals
from armodal.analyzer.gap.records import StiffnessRange
from armodal.analyzer.gap.search.hidden_size import HiddenSize
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["extreme_sizes", "hidden_sizes", "largest_size", "left_open", "stiffness_ranges"]

_WIDEST = 0.7  # of ln k
_FEW_STEPS = 3
# Probability that an unseen effect is there, beforehand: that of a false name one accepts. And the
# most nats of a look that count.
_BELIEVED, _SURE_NATS = 0.01, 50.0


def largest_size(candidate: Candidate, phi: float) -> float:
    """Return the 95 % limit of a hidden effect's size by the linear look."""
    return float(abs(candidate.size) + ONE_SIDED_95 * candidate.size_std * np.sqrt(phi))


def extreme_sizes(candidate: Candidate, final: Fit, phi: float) -> tuple[float, ...]:
    """Return by how much a hidden effect could differ in size from what the final model has."""
    instance = candidate.instance
    if instance.size in instance.relaxes:
        prior, here = instance.relaxes[instance.size], final.values[instance.size]
        reach = TWO_SIDED_95 * candidate.size_std * float(np.sqrt(phi))
        low, high = max(candidate.size - reach, prior.low), min(candidate.size + reach, prior.high)
        return low - here, high - here
    largest = largest_size(candidate, phi)
    one_sided = not instance.parameters or instance.parameters[0].low >= 0.0
    return (largest,) if one_sided else (largest, -largest)


def hidden_sizes(
    stage: Stage, best: Fit, hiding: Sequence[Candidate], phi: float
) -> list[HiddenSize]:
    """Return what could hide beside the best model, either way, not yet held against the data.

    Fewer lines than the sharp ones tell less, and at half the cost.
    """
    known = {instance.key for instance in best.hypothesis.instances}
    there = fit_hypothesis(
        stage, best.hypothesis, resumed=best, max_iterations=_FEW_STEPS, closing=False
    )
    return [
        HiddenSize(stage, there, c, limit, phi)
        for c in hiding
        if c.instance.key not in known
        for limit in _limits(c, best, phi)
    ]


def _limits(candidate: Candidate, best: Fit, phi: float) -> tuple[float, ...]:
    """95 % limits of a hidden size: by the linear look, by its prior where that is blind."""
    instance = candidate.instance
    if instance.hides_in:
        # Half a Gaussian: its 95 % limit is where a whole one has 2.5 % beyond.
        return tuple(TWO_SIDED_95 * p.std for p in instance.parameters if p.name == instance.size)
    return extreme_sizes(candidate, best, phi)


def stiffness_ranges(
    alive: Sequence[Fit], sizes: Sequence[HiddenSize], phi: float, *, settled: bool
) -> tuple[StiffnessRange, ...]:
    """Return what all models that stand and all that could hide leave of every stiffness, 95 %.

    An effect that nobody would see can still stand for a part of a joint's stiffness: a servo
    behind the transmission does. What of `sizes` matters is held against the data. The value is the
    best model's; where it is not settled which model is right, its deviation is that of the range.
    """
    best = alive[0]
    hiding = list({h.candidate.instance.key: h.candidate for h in sizes}.values())
    rows = []
    for i in best.hypothesis.ordinary.elastic:
        joint = best.hypothesis.ordinary.arm.joints[i].name
        name = f"ln k {joint}"
        found = [intervals(f, [name], phi)[name] for f in alive]
        k = float(np.exp(found[0].value))
        half = max(found[0].high - found[0].value, found[0].value - found[0].low)
        low, high = min(f.low for f in found), max(f.high for f in found)
        for side in (-1.0, 1.0):
            # Both are rarely at their limits at once: variances add.
            most = _most(sizes, name, side, half, k)
            end = found[0].value + side * float(np.hypot(most, half))
            low, high = min(low, end), max(high, end)
        std = found[0].std if settled else max(found[0].std, (high - low) / (2.0 * TWO_SIDED_95))
        std = float(np.hypot(std, left_open(hiding, best, name, phi)))
        rows.append(
            StiffnessRange(
                joint=joint,
                k_n_m_per_rad=k,
                k_std=k * std,
                low=float(np.exp(low)),
                high=float(np.exp(high)),
            )
        )
    return tuple(rows)


def _most(sizes: Sequence[HiddenSize], name: str, side: float, half: float, k: float) -> float:
    """How far hidden effects may move ln k of a joint, of which k is the best, to one side.

    What moves it by more than its own interval's `half` is held against the data, the farthest
    first: when that is known, nothing nearer matters.
    """

    def shift(hidden: HiddenSize, size: float) -> float:
        if hidden.candidate.instance.hides_in == name:
            # What is left to the joint of a compliance that stays as it was measured.
            along = side * -np.log(max(1.0 - size * k, np.exp(-_WIDEST)))
        else:
            along = side * hidden.candidate.follow.get(name, 0.0) * size
        # Beyond a factor of two the linear look says nothing but "very wide".
        return float(np.clip(along, 0.0, _WIDEST))

    open_ended = [hidden for hidden in sizes if shift(hidden, hidden.limit) > half]
    least = max((shift(h, h.limit) for h in sizes if h not in open_ended), default=0.0)
    while open_ended:
        farthest = max(open_ended, key=lambda h: (shift(h, h.at_most), h.is_known))
        if farthest.is_known or shift(farthest, farthest.at_most) <= least:
            least = max(least, shift(farthest, farthest.at_most))
            break
        own = farthest.candidate.instance.hides_in == name
        farthest.hold_against_data(half / (k if own else abs(farthest.candidate.follow[name])))
    return least


def left_open(hiding: Sequence[Candidate], best: Fit, name: str, phi: float) -> float:
    """Return the root mean square by which a parameter is off, if something unseen is there.

    A hammer far beyond its tolerance is hardly seen: all masses follow it within theirs, and every
    stiffness with them. That it is there has the probability p / (1 + p), p what the looks promise
    over what they are believed beforehand; then the parameter is off by what goes with it.
    """
    off = 0.0
    for c in hiding:
        there = c.size - best.values.get(c.instance.size, 0.0)
        shift = float(np.clip(c.follow.get(name, 0.0) * there, -_WIDEST, _WIDEST))
        odds = _BELIEVED * np.exp(min(c.gain / phi, _SURE_NATS))
        off = max(off, float(abs(shift) * np.sqrt(odds / (1.0 + odds))))
    return off
