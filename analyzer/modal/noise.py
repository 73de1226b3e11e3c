"""Variance of an averaged FRF from few hits.

Three hits leave two complex, four real, degrees of freedom a line: too few for a weight. The
scatter is therefore averaged over neighbouring lines, then drawn towards a two-part model that
all FRFs of the posture share, and held above the noise seen before the trigger:

    scatter   v1 = mean over 2m+1 lines of sum|X_h - H F_h|^2 / ((n - 1) sum|F_h|^2)
    model     v0 = c floor + r^2 |H|^2, r^2 the median over FRFs of the mean of (v1 - floor)/|H|^2
              on the quarter of lines where |H|^2 stands highest above the floor
    colour    c  = sum a (v1 - r^2 |H|^2)/floor / sum a over FRFs, a = (floor / v0)^2, line by line
    variance  v  = max(c floor, (nu1 v1 + nu0 v0) / (nu1 + nu0))

`floor` is the noise floor carried to the FRF, as white as the short record before the trigger has
it; c, at least 1, is how much more there is at a line: a sensor's noise rises towards low
frequencies, and so does what the floor of a laboratory brings (least squares, weighted by what
scatter scatters, drawn towards 1 as v1 is towards v0). r the relative scatter of hits (aim, level,
nonlinearity), nu1 the degrees of freedom of v1 and nu0 the weight of the model. With one hit
v = v0 with r = 1 %, and the floor is at least what differs from line to line about it: without a
second hit nothing else tells how much of a line between resonances is noise.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.running_median import running_median

__all__ = [
    "SMOOTHED_LINES",
    "hit_scatter_variance",
    "independent_line_share",
    "line_to_line_noise",
    "rough_level",
    "scatter_dof",
    "smooth_lines",
]

SMOOTHED_LINES = 4  # lines on either side: about nine lines, some four of them independent
_SINGLE_HIT_RELATIVE = 0.01
_MODEL_DOF = 12.0
_CLEAR_SHARE = 0.25
_SURROUNDINGS = 41  # lines of the running median: fewer than half of them a resonance's
_LEAST_ROUGHNESS = 0.5  # of 6, that independent lines have: smoother ones tell no noise


def smooth_lines(values: npt.NDArray[np.float64], half_width: int) -> npt.NDArray[np.float64]:
    """Mean over up to 2 `half_width` + 1 neighbouring lines, along the last axis.

    At the ends the mean runs over the lines there are.
    """
    n = values.shape[-1]
    total = np.concatenate([np.zeros_like(values[..., :1]), np.cumsum(values, axis=-1)], axis=-1)
    low = np.maximum(np.arange(n) - half_width, 0)
    high = np.minimum(np.arange(n) + half_width + 1, n)
    mean = (total[..., high] - total[..., low]) / (high - low)
    # A cumulative sum of a wide range of magnitudes may leave a negative rounding residue.
    positive: npt.NDArray[np.float64] = np.maximum(mean, 0.0)
    return positive


def rough_level(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.float64]:
    """Power |H_(k-1) - 2 H_k + H_(k+1)|^2 of second differences over lines (..., n_freq).

    Of noise alone it is six times the noise's power, of what is smooth next to nothing.
    """
    inner = np.abs(values[..., :-2] - 2.0 * values[..., 1:-1] + values[..., 2:]) ** 2
    ends = [(0, 0)] * (values.ndim - 1)
    return np.pad(inner, (*ends, (1, 1)), mode="edge")


def line_to_line_noise(
    values: npt.NDArray[np.complex128], decay_rad_s: float, line_spacing_hz: float
) -> npt.NDArray[np.float64]:
    """Power of what differs from line to line, a running median over lines: (..., n_freq).

    Under an exponential window lines m apart correlate (`independent_line_share`): their noise
    differs by less, (6 - 8 Re rho_1 + 2 Re rho_2) times its power.

    Parameters
    ----------
    values
        (..., n_freq), FRFs.
    decay_rad_s, line_spacing_hz
        The window's, and the distance of lines.

    Returns
    -------
    (..., n_freq) float64
        0 where lines are so much alike that they tell nothing, or too few.
    """
    c = decay_rad_s / line_spacing_hz
    near, next_but_one = (c**2 / (c**2 + (np.pi * m) ** 2) for m in (1, 2))
    share = 6.0 - 8.0 * near + 2.0 * next_but_one
    if share < _LEAST_ROUGHNESS or values.shape[-1] < _SURROUNDINGS:
        return np.zeros(values.shape)
    median = running_median(rough_level(values), _SURROUNDINGS)
    # The median of a squared magnitude of complex noise is ln 2 of its mean.
    result: npt.NDArray[np.float64] = median / (np.log(2.0) * share)
    return result


def independent_line_share(decay_rad_s: float, line_spacing_hz: float) -> float:
    """Independent lines per line for white noise under the exponential window.

    Lines m apart correlate by rho_m = c / (c + j pi m) with c = decay / line spacing (T the
    record, 1/T the spacing); the share is one over the sum of |rho_m|^2 over all m, which is
    tanh(c) / c.

    >>> independent_line_share(0.0, 1.0)
    1.0
    """
    c = decay_rad_s / line_spacing_hz
    return float(np.tanh(c) / c) if c > 0.0 else 1.0


def scatter_dof(n_hits: npt.NDArray[np.int64], independent_share: float) -> npt.NDArray[np.float64]:
    """Degrees of freedom of the variance of `hit_scatter_variance`, of the shape of `n_hits`."""
    lines = 1.0 + 2.0 * SMOOTHED_LINES * independent_share
    dof: npt.NDArray[np.float64] = np.asarray(2.0 * (n_hits - 1) * lines + _MODEL_DOF)
    return dof


def hit_scatter_variance(
    scatter: npt.NDArray[np.float64],
    floor: npt.NDArray[np.float64],
    magnitude_squared: npt.NDArray[np.float64],
    n_hits: npt.NDArray[np.int64],
    independent_share: float,
) -> npt.NDArray[np.float64]:
    """Variance E|error|^2 of averaged FRFs.

    Parameters
    ----------
    scatter
        (n_resp, n_ref, n_freq), sum|X_h - H F_h|^2 / ((n - 1) sum|F_h|^2); zero for one hit.
    floor
        (n_resp, n_ref, n_freq), the noise floor carried to the FRF.
    magnitude_squared
        (n_resp, n_ref, n_freq), |H|^2.
    n_hits
        (n_resp, n_ref).
    independent_share
        Independent lines per line under the window, in (0, 1].

    Returns
    -------
    (n_resp, n_ref, n_freq) float64
        Variance, positive wherever the floor is.
    """
    smoothed = smooth_lines(scatter, SMOOTHED_LINES)
    lines = 1.0 + 2.0 * SMOOTHED_LINES * independent_share
    dof = (2.0 * (n_hits - 1) * lines)[..., None]
    several = n_hits > 1
    if np.any(several):
        ratio = np.maximum(floor, np.finfo(float).tiny) / np.maximum(
            magnitude_squared, np.finfo(float).tiny
        )
        clear = ratio <= np.quantile(ratio, _CLEAR_SHARE, axis=-1, keepdims=True)
        share = np.where(clear, (smoothed - floor) / np.maximum(magnitude_squared, 1e-300), 0.0)
        mean = share.sum(axis=-1) / clear.sum(axis=-1)
        relative = max(float(np.median(mean[several])), 0.0)
    else:
        relative = _SINGLE_HIT_RELATIVE**2
    if np.any(several):
        colour = _colour(smoothed, floor, relative * magnitude_squared, dof, several)
        floor = np.multiply(floor, colour)
    model = floor + relative * magnitude_squared
    mixed = (dof * smoothed + _MODEL_DOF * model) / (dof + _MODEL_DOF)
    result: npt.NDArray[np.float64] = np.maximum(mixed, floor)
    return result


def _colour(
    smoothed: npt.NDArray[np.float64],
    floor: npt.NDArray[np.float64],
    by_signal: npt.NDArray[np.float64],
    dof: npt.NDArray[np.floating[Any]],
    several: npt.NDArray[np.bool_],
) -> npt.NDArray[np.float64]:
    """(n_freq,) noise of all FRFs over its white floor, line by line; at least 1.

    FRFs that the signal's own scatter rules have no say: a scatter varies as its mean does.
    """
    white = np.maximum(floor[several], np.finfo(float).tiny)
    weight = (white / (white + by_signal[several])) ** 2  # (n, n_freq)
    told = weight.sum(axis=0)
    excess = np.sum(weight * (smoothed[several] - by_signal[several]) / white, axis=0) / told
    freedom = np.sum(weight * dof[several], axis=0) ** 2 / np.sum(weight**2 * dof[several], axis=0)
    drawn = (freedom * excess + _MODEL_DOF) / (freedom + _MODEL_DOF)
    result: npt.NDArray[np.float64] = np.maximum(drawn, 1.0)
    return result
