"""How much evidence an effect needs: read from replicas of the session that do not have it.

The user states the probability of a false name that is accepted. On every replica the whole library
is looked at; what counts is how seldom its own kind gains as much, the least over all kinds. The
limit of that, and by it of every kind, is such that as many replicas as the user accepts have any
effect beyond its limit.

References
----------
Westfall and Young, Resampling-Based Multiple Testing (1993), chapter 2: the least p.
Davison and Hinkley, Bootstrap Methods and their Application (1997), section 4.2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.decision.matters import matters
from armodal.analyzer.gap.effects.level import any_change
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.inference.misfit import misfit_of_replicas, misfit_per_line
from armodal.analyzer.gap.library import all_instances, names_of_laws
from armodal.analyzer.gap.records import Calibrated
from armodal.analyzer.gap.search.candidates import others_beside
from armodal.analyzer.gap.search.levels import changes_with_level, fit_with
from armodal.analyzer.gap.search.replicas import replica_gains

__all__ = ["FALSE_NAME", "Calibration", "Calibrations", "Tail", "calibrate", "is_told_by_level"]

Array = npt.NDArray[np.float64]

FALSE_NAME = 0.01  # the user's: accepted probability of a false name
# Variance of errors in effects' directions, over what is assumed of a right model.
_MOST_ERROR = 1.0
_HALF = 0.5  # of replicas: more than they leave is worth a search
_UPPER = 0.05  # of replicas, by which a tail is modelled


@dataclass(frozen=True, slots=True, kw_only=True)
class Tail:
    """What a kind of effect gains by chance: exponential beyond a quantile.

    A gain is half a square of a Gaussian, or of some: its tail is exponential.
    """

    begin: float  # nats, what the upper part begins with
    scale: float  # nats, mean excess beyond

    @classmethod
    def of(cls, gains: Array) -> Tail:
        """Fit the tail of replicas' gains."""
        begin = float(np.quantile(gains, 1.0 - _UPPER))
        beyond = gains[gains > begin] - begin
        return cls(begin=begin, scale=float(beyond.mean()) if beyond.size else 0.0)

    def p_value(self, gain: float) -> float:
        """Return the probability of as much; at most that of the tail."""
        if gain <= self.begin:
            return 1.0
        return _UPPER * float(np.exp(-(gain - self.begin) / self.scale)) if self.scale else 0.0

    def limit(self, p: float) -> float:
        """Return the gain that is reached with a probability within the tail."""
        return self.begin + self.scale * float(np.log(_UPPER / min(p, _UPPER)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """Limits of one model's rivals."""

    false_name: float
    n_replicas: int
    tails: Mapping[str, Tail]  # by an effect's name
    whole: Tail  # of the largest gain of all: of effects without a linear look at all places
    least_p: float  # of a kind, that as many replicas reach as the user accepts
    dispersion: float
    error_ratio: float  # of error variance over what a right model is assumed to have

    def limit(self, name: str) -> float:
        """Nats of evidence that an effect needs, by its name."""
        if name in self.tails:
            return max(self.tails[name].limit(self.least_p), self.apart)
        return self.limit_otherwise

    @property
    def limit_otherwise(self) -> float:
        """Nats that effects need which no linear look tells."""
        return max(self.whole.limit(self.false_name), self.apart)

    def p_value(self, name: str, gain: float) -> float:
        """Probability that any effect of the library would look as clear by chance.

        Not below what one replica more than all could change (Davison and Hinkley, equation 4.11).
        """
        least = 1.0 / (self.n_replicas + 1)
        if name not in self.tails:
            return max(self.whole.p_value(gain), least)
        # As many kinds as the replicas say tell independently.
        p = self.tails[name].p_value(gain) * self.false_name / self.least_p
        return min(1.0, max(p, least))

    def odds(self, behind: float) -> float:
        """Odds of what is so many nats behind over what it is behind of."""
        return float(np.exp(-behind / self.inflation))

    def record(self) -> Calibrated:
        """Return it for the result."""
        return Calibrated(
            accepted_false_name=self.false_name,
            replicas=self.n_replicas,
            limits={name: self.limit(name) for name in sorted(self.tails)},
            limit_otherwise=self.limit_otherwise,
            tail=f"exponential beyond the upper {_UPPER:.0%} of replicas",
            dispersion=self.dispersion,
            error_ratio=self.error_ratio,
        )

    @property
    def apart(self) -> float:
        """Nats by which a rival must be behind: its odds are then those that are accepted."""
        return self.apart_from(1)

    def apart_from(self, n: int) -> float:
        """Nats that any of n has with no more than the accepted probability."""
        return float(np.log(n / self.false_name)) * self.inflation

    @property
    def is_model_wrong(self) -> bool:
        """Whether what is left is beyond what a right model may be off, where effects feel it."""
        return self.error_ratio > _MOST_ERROR

    @property
    def inflation(self) -> float:
        """Factor of the data's variance, for evidence and intervals: at least 1."""
        return max(self.dispersion, 1.0)


class Calibrations:
    """Calibrations of the models of a search; the last is kept, and what it was made of."""

    def __init__(self, false_name: float) -> None:
        self.false_name = false_name
        self._last: tuple[Stage, Fit, Fit, Calibration] | None = None

    def of(self, stage: Stage, present: Fit, rivals: Sequence[Fit]) -> Calibration:
        """Return the limits for rivals of a model."""
        best = min([present, *rivals], key=lambda fit: fit.evidence)
        last = self._last
        if last is None or last[0] is not stage or last[1] is not present or last[2] is not best:
            found = calibrate(stage, present, best, self.false_name)
            if last is not None and last[0] is stage and last[1] is present:
                # A model is wrong where it errs with its best rival and without.
                least = min(last[3].error_ratio, found.error_ratio)
                found = replace(found, error_ratio=least)
            last = self._last = stage, present, best, found
        return last[3]

    def limit(self, stage: Stage, present: Fit, name: str) -> float:
        """Return the nats that an effect needs beside a model, by its name."""
        return self.of(stage, present, ()).limit(name)

    def needs_more(self, stage: Stage, present: Fit, begun: Sequence[Fit]) -> bool:
        """Whether anything is to be explained.

        What matters and has its limit in reach, what the hits' level tells, a misfit that half of
        the replicas do not leave, errors that no right model has, or ordinary ones as far as any
        is tried: those stand for something else.
        """
        if present.ordinary_at_limit:
            return True
        if misfit_per_line(stage, present) > misfit_of_replicas(stage, present, _HALF):
            return True
        limits = self.of(stage, present, begun)
        if limits.is_model_wrong or is_told_by_level(stage, present, limits):
            return True
        return any(
            present.evidence - f.evidence + f.promised > limits.limit(f.last.effect.name)
            for f in begun
            if matters(stage, present, f, f.last, limits.inflation)
        )


def is_told_by_level(stage: Stage, fit: Fit, calibration: Calibration) -> bool:
    """Whether the hits' level tells what no effect of a model follows, and what matters.

    By a look at each joint, and a fit of what it promises: it may promise more than a fit keeps.
    Chance must bring any of them as much more seldom than is accepted. What the level tells is in
    the dispersion too: a larger limit, where more of it is not followed.
    """
    changes = changes_with_level(stage, fit)
    least = calibration.apart_from(len(changes) or 1)
    promising = (change.instance for change in changes if change.gain > least)
    fitted = (fit_with(stage, fit, change) for change in promising)
    return any(
        fit.evidence - f.evidence > least and matters(stage, fit, f, f.last, calibration.inflation)
        for f in fitted
    )


def calibrate(stage: Stage, present: Fit, best: Fit, false_name: float = FALSE_NAME) -> Calibration:
    """Return the limits for rivals of a model.

    Parameters
    ----------
    present, best
        The model without a further effect, and that of best evidence: itself or a rival.
    """
    added = () if best is present else best.hypothesis.instances[-1:]
    null = present.hypothesis
    looks = () if null.level_dependent else any_change(null.ordinary)
    drawn = replica_gains(stage, best, added, [*others_beside(best), *looks])
    by_kind: dict[str, list[Array]] = {}
    for instance, gains in zip(drawn.instances, drawn.replicas, strict=True):
        by_kind.setdefault(instance.effect.name, []).append(gains)
    of_any = np.max(drawn.replicas, axis=0)
    # What was sought anywhere, a point or a line, is here but where it was found: its own gains are
    # those of one place, and it was the best of many.
    everywhere = {i.effect.name for i in (*all_instances(best.hypothesis.ordinary), *looks)}
    largest = {name: np.max(own, axis=0) for name, own in by_kind.items() if name in everywhere}
    tails = {name: Tail.of(gains) for name, gains in largest.items()}
    of_each = [
        np.array([tails[name].p_value(gain) for gain in gains]) for name, gains in largest.items()
    ]
    least = np.min(of_each, axis=0)
    for look in looks[:1]:
        tails |= dict.fromkeys(names_of_laws(), tails.pop(look.effect.name))
    return Calibration(
        false_name=false_name,
        n_replicas=drawn.replicas.shape[1],
        tails=tails,
        whole=Tail.of(of_any),
        least_p=float(np.quantile(least, false_name)),
        dispersion=drawn.dispersion,
        error_ratio=drawn.error_ratio,
    )
