"""A fit's parameters with their standard deviations and 95 % intervals, at bounds too."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from armodal.analyzer.confidence import ONE_SIDED_95, TWO_SIDED_95
from armodal.analyzer.gap.inference.fit import Fit
from armodal.analyzer.gap.records import Interval

__all__ = ["intervals"]


def intervals(fit: Fit, names: Sequence[str], inflation: float) -> dict[str, Interval]:
    """Return those of the names that the fit has.

    A parameter that rests at a bound has the bound for one end and a one-sided 95 % limit for the
    other, and the deviation that limit would be 1.645 times of.

    Parameters
    ----------
    inflation
        Of the data's variance.
    """
    values = fit.values
    covariance = fit.covariance(inflation)
    found = {}
    for name in names:
        if name not in fit.space.index:
            continue
        i = fit.space.index[name]
        p = fit.space.parameters[i]
        value = values[name]
        if fit.free[i]:
            std = float(np.sqrt(covariance[i, i])) * p.std
            low, high = value - TWO_SIDED_95 * std, value + TWO_SIDED_95 * std
        else:
            inward = _limit_from_bound(fit, i, covariance, inflation) * p.std
            std = inward / ONE_SIDED_95
            rests_low = fit.slope[i] > 0.0
            low, high = (value, value + inward) if rests_low else (value - inward, value)
        found[name] = Interval(
            unit=p.unit, value=value, std=std, low=max(low, p.low), high=min(high, p.high)
        )
    return found


def _limit_from_bound(
    fit: Fit,
    i: int,
    covariance: np.ndarray[tuple[int, int], np.dtype[np.float64]],
    inflation: float,
) -> float:
    """How far inside its bound a parameter is at most (95 %), in prior deviations.

    Its density falls as exp(-g d - h d^2 / 2) with the distance d, g the slope of the cost and h
    its curvature with the free parameters following: a Gaussian's upper part.
    """
    f = fit.free
    across = fit.curvature[i, f] / inflation
    h = fit.curvature[i, i] / inflation + 1.0 - across @ covariance[np.ix_(f, f)] @ across
    # Inwards. Below zero where the data alone hold it there, and weigh less than its prior now.
    g = np.sign(fit.slope[i]) * ((fit.slope[i] - fit.u[i]) / inflation + fit.u[i])
    alpha = g / np.sqrt(h)
    beyond = -scipy.special.ndtri_exp(np.log(0.05) + scipy.special.log_ndtr(-alpha))
    return float((beyond - alpha) / np.sqrt(h))
