"""Whether a joint that is softer for harder hits slips: what hits between soft and hard tell.

A seat that slips little by little loses most where most of it begins to slip (W. D. Iwan, J. Appl.
Mech. 33 (1966) 893). Where that lies between soft and hard hits, both find the same damping as
of a spring that softens without a loss, and two levels cannot tell. The hits between can: there the
damping of the seat bows up. With A the fall of ln k from the middle of the levels to the hardest,
b A what ln c grows by meanwhile and r A its bow, sealed cases had

    softening    b = 0.35 +- 0.3, r = 0.2 +- 0.45,
    microslip    r = 1.7 +- 0.5 where b is as small,
    friction     b below -0.9, r = 0.3 +- 0.5 where b is above -2

(`docs/decisions/0020-hits-between-soft-and-hard.md`). Softening's own part is the sweep through its
frequencies while a swing dies away.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy import special

from armodal.analyzer.confidence import TWO_SIDED_95
from armodal.analyzer.gap.decision.judge import Judged
from armodal.analyzer.gap.effects import friction, microslip, softening
from armodal.analyzer.gap.effects.level import any_bow
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.search.levels import weighed_anew

__all__ = ["Bow", "asks_for_levels", "bow_of", "told_by_bow", "told_by_hits_between"]

Array = npt.NDArray[np.float64]

_NAMES = (softening.WORDS.name, microslip.WORDS.name)
_SOFTENING_MEAN, _SOFTENING_STD = np.array([0.35, 0.2]), np.array([0.3, 0.45])  # of b, r
# What slides, little by little or whole: its b, anywhere between; its r.
_SLIDES = (((-0.5, 3.5), 1.7, 0.5), ((-10.0, -0.5), 0.3, 0.5))
_TOLD = 10.0  # times as likely as the other
_ALIKE = (*_NAMES, friction.WORDS.name)
_ROUNDS, _STEPS = 2, 8
_SAID = {
    _NAMES[0]: "which is a spring that softens",
    _NAMES[1]: "which is a seat that slips",
    None: "which may be either of a spring that softens and a seat that slips",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Bow:
    """How a joint's damping goes with the level, in units of the fall of ln k."""

    slope: float  # b
    bow: float  # r
    covariance: Array  # (2, 2) of both


def told_by_hits_between(
    judged: Judged, sharp: Stage, between: Callable[[Stage], Stage | None], apart: float
) -> tuple[Judged, list[str]]:
    """Softening or microslip of one joint, where either could be the name; what is said of it.

    Friction of that joint, where it stands beside, slides too. A crack that opens under one sign
    looks like all three: what slides is not told from what sticks here.

    Parameters
    ----------
    judged
        What stands by soft and hard hits.
    between
        Gives lines of three levels, if there are any (`stages.at_three_levels`).
    apart
        Nats by which rivals are told apart.
    """
    both = _both(judged, sharp, apart)
    if both is None:
        return judged, []
    joint = both[0].last.place
    told: str | None = None
    words = f"hits between soft and hard would tell whether {joint} softens or slips"
    stage = between(sharp)
    if stage is not None:
        bow = bow_of(stage, both[0], joint, judged.phi)
        told = told_by_bow(bow)
        half = TWO_SIDED_95 * np.sqrt(bow.covariance[1, 1])
        words = (
            f"hits between soft and hard: the damping of {joint} bows by {bow.bow:.2f} "
            f"+- {half:.2f} of the fall of ln k, {_SAID[told]}"
        )
    sticks = [f for f in judged.standing if f.last.key == (friction.WORDS.name, joint)]
    if sticks and told != softening.WORDS.name:
        return judged, [words] if told is None else []
    others = [f for f in judged.standing if all(f is not own for own in (*both, *sticks))]
    kept = [f for f in both if told in (None, f.last.effect.name)]
    standing = tuple(sorted([*kept, *others], key=lambda f: f.evidence))
    named = standing[0] if len(standing) == 1 else None
    # Of what was told by the bow, at least ten times as likely as the other.
    confidence = judged.confidence if told is None else _TOLD / (1.0 + _TOLD)
    judged = replace(judged, named=named, standing=standing, confidence=confidence)
    return judged, [words]


def told_by_bow(bow: Bow) -> str | None:
    """Return "softening" or "microslip", ten times as likely as the other by sealed cases.

    As microslip counts whatever slides.
    """
    softens, slides = _softens(bow), _slides(bow)
    if max(softens, slides) < _TOLD * min(softens, slides):
        return None
    return _NAMES[0] if softens > slides else _NAMES[1]


def _softens(bow: Bow) -> float:
    """Density of slope and bow."""
    off = np.array([bow.slope, bow.bow]) - _SOFTENING_MEAN
    spread = bow.covariance + np.diag(_SOFTENING_STD**2)
    chi2 = off @ np.linalg.solve(spread, off)
    return float(np.exp(-0.5 * chi2) / np.sqrt(np.linalg.det(2.0 * np.pi * spread)))


def _slides(bow: Bow) -> float:
    """Likewise: the slope anywhere in a range, the bow as it is there."""
    of_slope = np.sqrt(bow.covariance[0, 0])
    found = 0.0
    for ends, mean, std in _SLIDES:
        low, high = special.ndtr((np.array(ends) - bow.slope) / of_slope)
        of_bow = np.sqrt(bow.covariance[1, 1] + std**2)
        here = np.exp(-0.5 * ((bow.bow - mean) / of_bow) ** 2) / (np.sqrt(2.0 * np.pi) * of_bow)
        found += (high - low) / (ends[1] - ends[0]) * here
    return float(found)


def bow_of(stage: Stage, fit: Fit, joint: str, phi: float) -> Bow:
    """Refit with the joint free to bow with the level, in the place of the last effect.

    Parameters
    ----------
    stage
        Lines of three levels.
    fit
        On the sharp lines of soft and hard hits, with an effect of the level at the joint.
    phi
        Of the data's variance.
    """
    *others, _ = fit.hypothesis.instances
    span = max(lines.level for lines in stage.lines)
    instance, (by_k, by_c, bow_c) = any_bow(joint, span)
    hypothesis = replace(fit.hypothesis, instances=(*others, instance))
    values = fit.values
    for _ in range(_ROUNDS):
        free = fit_hypothesis(stage, hypothesis, start=values, max_iterations=_STEPS)
        values = free.values
        lines = weighed_anew(stage, free)
        stage = Stage(hypothesis.ordinary.superset, lines, Discrepancy(), models=stage.models)
    fall = max(values[by_k] * span, 1e-6)
    at = [free.space.index[name] for name in (by_c, bow_c)]
    unit = free.space.std[at] * np.array([span, 1.0]) / fall
    covariance = free.covariance(phi)[np.ix_(at, at)] * np.outer(unit, unit)
    return Bow(slope=values[by_c] * span / fall, bow=values[bow_c] / fall, covariance=covariance)


def asks_for_levels(standing: Sequence[Fit]) -> bool:
    """Whether one joint softens or slips by what stands, and no hits between were there to tell."""
    last = [fit.last for fit in standing if fit.hypothesis.instances]
    softens, slips = ({i.place for i in last if i.effect.name == name} for name in _NAMES)
    return bool(softens & slips) and not standing[0].hypothesis.ordinary.hits_between


def _both(judged: Judged, sharp: Stage, apart: float) -> tuple[Fit, Fit] | None:
    """Fits of softening and of microslip of one joint, if what is best is one of them or friction.

    None where soft and hard hits tell them apart.
    """
    best = next(iter(judged.standing), None)
    if best is None or not best.hypothesis.instances or best.last.effect.name not in _ALIKE:
        return None
    if best.last.law is not None:
        return None  # told by its own law
    of_joint = [f for f in judged.standing if f.hypothesis.instances]
    of_joint = [f for f in of_joint if f.last.place == best.last.place]
    either = [f for f in of_joint if f.last.effect.name in _NAMES]
    if not either:
        return None
    one, *more = either
    other = next((f for f in more if f.last.key != one.last.key), None)
    if other is None:
        other = _with_twin(one, sharp)
    return None if other.evidence - best.evidence > apart * judged.phi else (one, other)


def _with_twin(fit: Fit, sharp: Stage) -> Fit:
    """Softening in the place of microslip, or the other way round."""
    last = fit.last
    twin = _twin(last, fit.hypothesis)
    start = fit.values | {
        theirs.name: min(max(fit.values[own.name], theirs.low), theirs.high)
        for own, theirs in zip(last.parameters, twin.parameters, strict=True)
    }
    instances = (*fit.hypothesis.instances[:-1], twin)
    hypothesis = replace(fit.hypothesis, instances=instances)
    return fit_hypothesis(sharp, hypothesis, start=start, max_iterations=_STEPS)


def _twin(instance: Instance, hypothesis: Hypothesis) -> Instance:
    softens = instance.effect.name == softening.WORDS.name
    instances_of = microslip.instances if softens else softening.instances
    return next(i for i in instances_of(hypothesis.ordinary) if i.place == instance.place)
