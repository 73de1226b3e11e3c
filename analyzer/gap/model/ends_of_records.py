"""What the ends of records tell of noise, where nothing else does: every point was hit once.

The few samples before a hit do not show slow noise. By its end a record has rung down, and what
still rings there counts as noise too. With r(tau) the noise's autocorrelation and w the window,
noise n(t) w(t) has on a line the power

    E|N(f)|^2 = sum over tau of r(tau) c(tau) cos(2 pi f tau),
    c(tau) = sum over t of w(t) w(t + tau)

(Wiener and Khinchin; Bendat and Piersol, Random Data, 4th ed. (2010), ch. 5).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.spectra import active_channels
from armodal.analyzer.modal.windows import highpass_response
from armodal.protocols.session.records import Hit, Session

__all__ = ["noise_at_ends", "windowed_noise_power"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_FROM = 0.5  # of a record: what comes later is its end


def noise_at_ends(session: Session, hits: Sequence[Hit], s_rad_s: ComplexArray) -> Array:
    """(n_hits, 3, n_lines) power of the noise of each hit's accelerances, (m/(N s^2))^2.

    Parameters
    ----------
    hits
        Their records begin shortly before the trigger.
    s_rad_s
        Lines with one real part, the window's decay.
    """
    force_channel, channels, columns = active_channels(session)
    rate = float(session.header.plan.sampling.rate_hz)
    s = s_rad_s.astype(np.complex128)
    scale = np.array([channel.scale for channel in channels])
    gain = np.array([1.0 / np.abs(highpass_response(s, c.highpass_hz)) ** 2 for c in channels])
    found = []
    for hit in hits:
        counts = hit.counts[:, columns].T.astype(np.float64)
        quiet = counts[:, : max(int(hit.trigger_sample - hit.first_sample) - 2, 2)]
        counts -= quiet.mean(axis=1, keepdims=True)
        begin = int(_FROM * counts.shape[1])
        power = windowed_noise_power(scale[:, None] * counts[1:, begin:], rate, s_rad_s) * gain
        waves = np.exp(-np.outer(np.arange(begin) / rate, s_rad_s))
        force = force_channel.scale * counts[0, :begin] @ waves / rate
        found.append(power / np.abs(force) ** 2)
    return np.array(found)


def windowed_noise_power(noise: Array, rate_hz: float, s_rad_s: ComplexArray) -> Array:
    """(n, n_lines) power on lines s = decay + j w of noise like (n, n_samples), under e^(-decay t).

    The window is as long as the noise is.
    """
    n = noise.shape[1]
    decay, f_hz = float(s_rad_s[0].real), s_rad_s.imag / (2.0 * np.pi)
    window = np.exp(-decay / rate_hz * np.arange(n))
    lags = np.arange(n)
    of_noise = _autocorrelation(noise) / n
    weight = np.where(lags > 0, 2.0, 1.0) * of_noise * _autocorrelation(window[None])
    waves = np.cos(2.0 * np.pi / rate_hz * np.outer(lags, f_hz))
    return np.asarray(np.maximum(weight @ waves, 0.0) / rate_hz**2)


def _autocorrelation(x: Array) -> Array:
    """(..., n) sums over t of x(t) x(t + tau)."""
    n = x.shape[-1]
    power = np.abs(np.fft.rfft(x, 2 * n)) ** 2
    return np.asarray(np.fft.irfft(power, 2 * n)[..., :n])
