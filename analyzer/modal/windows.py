"""Windows on a hit record and the correction of AC coupling.

The exponential multiplies force and response alike. With x(t) = (h * f)(t) and h causal,

    X(a + jw) = integral of x(t) e^(-a t) e^(-jwt) dt = H(a + jw) F(a + jw),

so the ratio of the windowed spectra is the transfer function itself on the line Re s = a: the
window adds no damping that would have to be taken off again.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import EstimateError

__all__ = [
    "exponential_decay",
    "exponential_window",
    "force_window",
    "highpass_response",
    "laplace_lines",
    "undo_highpass",
]

_TAPER = 0.125  # of the force window's length: half-cosine that ends it


def exponential_decay(end: float, duration_s: float) -> float:
    """Decay rate of an exponential that falls to `end` over `duration_s`.

    Parameters
    ----------
    end
        Value at the record's end, in (0, 1]; 1 is no window.
    duration_s
        Length of the record.

    Returns
    -------
    float
        Decay in rad/s, not negative.

    Raises
    ------
    EstimateError
        If `end` is not in (0, 1] or the record has no length.
    """
    if not 0.0 < end <= 1.0:
        raise EstimateError(
            f"exponential window: wanted an end value in (0, 1], got {end}; "
            "correct windows.exponential_end in the plan"
        )
    if not duration_s > 0.0:
        raise EstimateError(
            f"exponential window: wanted a record longer than 0 s, got {duration_s}"
        )
    return float(-np.log(end) / duration_s)


def exponential_window(
    n_samples: int, rate_hz: float, decay_rad_s: float
) -> npt.NDArray[np.float64]:
    """Exponential e^(-decay t), t from the first sample: (n_samples,)."""
    times_s = np.arange(n_samples, dtype=np.float64) / rate_hz
    window: npt.NDArray[np.float64] = np.exp(-decay_rad_s * times_s)
    return window


def force_window(
    n_samples: int, rate_hz: float, trigger: int, length_s: float
) -> npt.NDArray[np.float64]:
    """Window that keeps the force up to `length_s` after the trigger: (n_samples,).

    One before the end, a half-cosine over the last eighth of the length, zero after it. The
    length must hold the whole pulse; what is cut off of it is missing in every FRF.

    Raises
    ------
    EstimateError
        If the length is not above 0.
    """
    if not length_s > 0.0:
        raise EstimateError(
            f"force window: wanted a length above 0 s, got {length_s}; correct windows.force_s in "
            "the plan"
        )
    after_s = (np.arange(n_samples) - trigger) / rate_hz
    taper_s = _TAPER * length_s
    position = np.clip((after_s - (length_s - taper_s)) / taper_s, 0.0, 1.0)
    window: npt.NDArray[np.float64] = 0.5 + 0.5 * np.cos(np.pi * position)
    return window


def highpass_response(
    s: npt.NDArray[np.complex128], corner_hz: float
) -> npt.NDArray[np.complex128]:
    """Transfer function s / (s + wc) of first-order AC coupling at the Laplace points `s`."""
    return s / (s + 2.0 * np.pi * corner_hz)


def laplace_lines(
    freq_hz: npt.NDArray[np.float64], decay_rad_s: float
) -> npt.NDArray[np.complex128]:
    """Laplace points s = decay + j 2 pi f of the lines: (n_freq,)."""
    lines = np.empty(freq_hz.shape, dtype=np.complex128)
    lines.real = decay_rad_s
    lines.imag = 2.0 * np.pi * freq_hz
    return lines


def undo_highpass(
    signal: npt.NDArray[np.float64], rate_hz: float, corner_hz: float
) -> npt.NDArray[np.float64]:
    """Undo first-order AC coupling in the time domain, along the last axis.

    From y = s/(s + wc) x follows x = y + wc times the integral of y (trapezoidal rule). Used on
    the force alone, before a force window cuts the droop behind the pulse; everywhere else the
    spectrum is corrected instead.
    """
    steps = 0.5 * (signal[..., 1:] + signal[..., :-1])
    integral = np.concatenate([np.zeros_like(signal[..., :1]), np.cumsum(steps, axis=-1)], axis=-1)
    return signal + 2.0 * np.pi * corner_hz / rate_hz * integral
