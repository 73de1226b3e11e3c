"""Hammer strikes as a board records them: any pulse, a second one, filter, coupling, noise.

Pulses are drawn on a grid fine against both pulse and sample, low-passed by the anti-alias filter's
frequency response, sampled, high-passed and made noisy. Nothing here is shared with the judge.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy import signal

__all__ = ["FILTERS", "SHAPES", "Strike", "draw_strike", "force_record", "gap_of", "second_strike"]

Array = npt.NDArray[np.float64]

SHAPES = ("half-sine", "haversine", "skewed")
FILTERS = (
    "elliptic",
    "elliptic-10",
    "chebyshev",
    "butterworth",
    "sigma-delta",
    "fir",
    "gaussian",
    "none",
)
END_SHARE = 0.02  # of a pulse's peak: where it ends
_FINE_PER_PULSE = 48


@dataclass(frozen=True, slots=True, kw_only=True)
class Strike:
    """One recorded blow; a `second` share of 0 is a single pulse.

    `gap_s` runs from where the first pulse has fallen to 2 % of its peak to where the second
    begins. Shares are of the first pulse's peak.
    """

    rate_hz: float
    width_s: float  # foot to foot
    shape: str
    skew: float  # exponent of time; 1 is symmetric
    peak_n: float
    second: float
    gap_s: float
    second_width_s: float
    filter_kind: str
    cutoff: float  # over the sampling rate
    highpass_hz: float
    noise: float
    hum: float
    drift: float


def draw_strike(rng: np.random.Generator, *, rate_hz: float, width_s: float) -> Strike:
    """A single good pulse with everything else drawn from what boards and hands do.

    White noise 0.02 to 0.5 % rms, 50 Hz hum with a third harmonic 0.01 to 1 %, drift up to 1 % over
    the record, high-pass corner 5 mHz to 1 Hz.
    """
    return Strike(
        rate_hz=rate_hz,
        width_s=width_s,
        shape=str(rng.choice(SHAPES)),
        skew=float(rng.uniform(0.6, 1.6)),
        peak_n=float(np.exp(rng.uniform(np.log(40.0), np.log(400.0)))),
        second=0.0,
        gap_s=0.0,
        second_width_s=width_s,
        filter_kind=str(rng.choice(FILTERS)),
        cutoff=float(rng.uniform(0.36, 0.48)),
        highpass_hz=float(np.exp(rng.uniform(np.log(0.005), np.log(1.0)))),
        noise=float(np.exp(rng.uniform(np.log(2e-4), np.log(5e-3)))),
        hum=float(np.exp(rng.uniform(np.log(1e-4), np.log(1e-2)))),
        drift=float(rng.uniform(-0.01, 0.01)),
    )


def second_strike(
    strike: Strike, rng: np.random.Generator, *, second: float, gap_s: float
) -> Strike:
    """The same with a second pulse 0.8 to 1.4 times as wide, at least two samples."""
    width_s = max(strike.width_s * float(rng.uniform(0.8, 1.4)), 2.0 / strike.rate_hz)
    return replace(strike, second=second, gap_s=gap_s, second_width_s=width_s)


def gap_of(rng: np.random.Generator, rate_hz: float, longest_s: float) -> float:
    """A gap of at least 3 ms and 3 samples, logarithmically uniform."""
    return float(np.exp(rng.uniform(np.log(max(3e-3, 3.0 / rate_hz)), np.log(longest_s))))


def _pulse(strike: Strike, t: Array, width_s: float) -> Array:
    x = np.clip(t / width_s, 0.0, 1.0)
    if strike.shape == "haversine":
        value: Array = np.sin(np.pi * x) ** 2
    elif strike.shape == "skewed":
        value = np.sin(np.pi * x**strike.skew)
    else:
        value = np.sin(np.pi * x)
    return value


def _end_of_first_s(strike: Strike) -> float:
    t = np.linspace(0.0, strike.width_s, 4001)
    above = np.flatnonzero(_pulse(strike, t, strike.width_s) > END_SHARE)
    return float(t[above[-1]])


def _response(strike: Strike, x: Array) -> npt.NDArray[np.complex128]:
    """Frequency response of the anti-alias filter at frequencies over the sampling rate."""
    if strike.filter_kind == "sigma-delta":
        # Linear phase; flat to the cut-off, gone a tenth of the rate above it.
        fall = np.clip((x - strike.cutoff) / 0.093, 0.0, 1.0)
        return (0.5 + 0.5 * np.cos(np.pi * fall)).astype(np.complex128)
    if strike.filter_kind == "gaussian":
        # -3 dB at 0.7 of the cut-off: the filter of a board made for transients.
        return np.exp(-0.5 * np.log(2.0) * (x / (0.7 * strike.cutoff)) ** 2).astype(np.complex128)
    if strike.filter_kind == "none":
        return np.ones(x.shape, dtype=np.complex128)
    if strike.filter_kind == "fir":
        # Windowed sinc of 41 samples, eight taps a sample, its delay taken off.
        taps = signal.firwin(321, strike.cutoff, window=("kaiser", 6.0), fs=8.0)
        spectrum = np.fft.rfft(taps, 8 * round(1.0 / x[1]))[: len(x)]
        return spectrum * np.exp(2j * np.pi * 20.0 * x)
    corner = 2.0 * np.pi * strike.cutoff
    if strike.filter_kind == "elliptic-10":
        b, a = signal.ellip(10, 0.5, 100.0, corner, analog=True)
        return np.asarray(signal.freqs(b, a, 2.0 * np.pi * x)[1], dtype=np.complex128)
    if strike.filter_kind == "elliptic":
        b, a = signal.ellip(7, 0.1, 80.0, corner, analog=True)
    elif strike.filter_kind == "chebyshev":
        b, a = signal.cheby1(8, 0.1, corner, analog=True)
    else:
        b, a = signal.butter(8, corner, analog=True)
    return np.asarray(signal.freqs(b, a, 2.0 * np.pi * x)[1], dtype=np.complex128)


def _filtered(strike: Strike, n: int, at: float) -> Array:
    """Pulses behind the anti-alias filter, one sample apart, of unit first peak; foot at `at`."""
    fine = max(8, math.ceil(_FINE_PER_PULSE / (strike.width_s * strike.rate_hz)))
    t = np.arange(n * fine) / (fine * strike.rate_hz) - at / strike.rate_hz
    force = _pulse(strike, t, strike.width_s)
    if strike.second:
        later = t - _end_of_first_s(strike) - strike.gap_s
        force = force + strike.second * _pulse(strike, later, strike.second_width_s)
    # Nothing passes the filters above 1.5 times the rate: three samples a sample hold it all.
    kept = np.fft.rfft(force)[: 3 * n // 2 + 1]
    kept = kept * _response(strike, np.arange(len(kept)) / n)
    return np.fft.irfft(kept, 3 * n)[::3] * (3.0 / fine)


def force_record(
    strike: Strike, rng: np.random.Generator, *, n: int, pretrigger: int, level_n: float
) -> Array:
    """One force record in N, (n,), the first sample at or above the level at `pretrigger`."""
    clean = strike.peak_n * _filtered(strike, n, pretrigger + float(rng.random()))
    crossed = int(np.argmax(clean >= level_n))
    clean = np.roll(clean, pretrigger - crossed)
    if strike.highpass_hz > 0.0:
        b, a = signal.butter(1, strike.highpass_hz, "highpass", fs=strike.rate_hz)
        clean = signal.lfilter(b, a, clean)
    t = np.arange(n) / strike.rate_hz
    phase = rng.uniform(0.0, 2.0 * np.pi, 2)
    hum = np.sin(2.0 * np.pi * 50.0 * t + phase[0])
    hum = hum + 0.3 * np.sin(2.0 * np.pi * 150.0 * t + phase[1])
    disturbance = strike.hum * hum + strike.drift * (t / t[-1]) ** rng.uniform(0.3, 3.0)
    disturbance = disturbance + strike.noise * rng.standard_normal(n)
    return clean + strike.peak_n * disturbance
