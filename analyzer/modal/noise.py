"""Variance of an averaged FRF from few hits.

Three hits leave two complex, four real, degrees of freedom a line: too few for a weight. The
scatter is therefore averaged over neighbouring lines, then drawn towards a two-part model that
all FRFs of the posture share, and held above the noise seen before the trigger:

    scatter   v1 = mean over 2m+1 lines of sum|X_h - H F_h|^2 / ((n - 1) sum|F_h|^2)
    model     v0 = floor + r^2 |H|^2, r^2 the median over FRFs of the mean of (v1 - floor)/|H|^2
              on the quarter of lines where |H|^2 stands highest above the floor
    variance  v  = max(floor, (nu1 v1 + nu0 v0) / (nu1 + nu0))

`floor` is the noise floor carried to the FRF, r the relative scatter of hits (aim, level,
nonlinearity), nu1 the degrees of freedom of v1 and nu0 the weight of the model. With one hit
v = v0 with r = 1 %.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = [
    "SMOOTHED_LINES",
    "hit_scatter_variance",
    "independent_line_share",
    "scatter_dof",
    "smooth_lines",
]

SMOOTHED_LINES = 4  # lines on either side: about nine lines, some four of them independent
_SINGLE_HIT_RELATIVE = 0.01
_MODEL_DOF = 12.0
_CLEAR_SHARE = 0.25


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
    model = floor + relative * magnitude_squared
    mixed = (dof * smoothed + _MODEL_DOF * model) / (dof + _MODEL_DOF)
    result: npt.NDArray[np.float64] = np.maximum(mixed, floor)
    return result
