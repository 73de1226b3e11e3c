r"""What the anti-alias filter of a board makes of one short pulse.

A steep low-pass rings at its cut-off, after the pulse, and before it too if its phase is linear. A
board does not say which filter it has, so the lobes are bounded over a bank of the usual ones:
half-sines from half a sample to six samples wide, at four positions between the samples, through
elliptic, Chebyshev, Butterworth and linear-phase filters cut off at 0.30 to 0.49 of the sampling
rate.

The binomial kernel (1, 4, 6, 4, 1)/16 has the gain :math:`\cos^4(\pi f / f_s)`, 12 % at 0.3 and
1 % at 0.4 of the rate: behind it little is left of the ringing, and of a pulse of two samples a
good half.

References
----------
Filters: Oppenheim and Schafer, Discrete-Time Signal Processing, 3rd ed. (2010), ch. 4.8 and 7.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy import signal

__all__ = ["REACH", "SMOOTHING", "largest_lobes", "smoothed"]

Array = npt.NDArray[np.float64]

SMOOTHING: Array = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16.0
REACH = 32  # samples on either side of the peak that the lobes are followed

_N = 4 * REACH
_PER_SAMPLE = 4  # positions of the pulse between two samples
_WIDTHS = (0.5, 1.5, 2.0, 3.0, 4.0, 6.0)
_CUTOFFS = (0.30, 0.35, 0.42, 0.49)
_ALIKE = 0.5  # samples of half width that pulses of the bank may differ from the recorded one


def smoothed(force: Array) -> Array:
    """Force behind the binomial kernel, of the same length."""
    return np.convolve(force, SMOOTHING, mode="same")


def largest_lobes(half_width: float) -> Array:
    """Largest side lobe one pulse may leave in the smoothed force, by its distance.

    Parameters
    ----------
    half_width
        Full width at half the peak, in samples, as recorded.

    Returns
    -------
    (REACH,) float64
        Prominence over the peak of lobes 1, 2, ... samples from the peak or farther, over all
        pulses of the bank recorded about as wide. Zero for pulses too wide to make the filter ring.
    """
    widths, lobes = _bank()
    alike = np.abs(widths - max(half_width, float(widths.min()))) <= _ALIKE
    largest: Array = lobes[alike].max(axis=0, initial=0.0)
    return largest


@lru_cache(maxsize=1)
def _bank() -> tuple[Array, Array]:
    """Recorded half width of every pulse of the bank, and its lobes (n_pulses, REACH)."""
    n_fine = 24 * _N
    freq = np.arange(_N * _PER_SAMPLE // 2) / _N
    t = np.arange(n_fine) * (_N / n_fine) - _N / 2
    pulses = [np.sin(np.pi * np.clip(t / width + 0.5, 0.0, 1.0)) for width in _WIDTHS]
    spectra = np.fft.rfft(np.array(pulses), axis=1)[:, : len(freq)]
    passed = spectra[:, None, :] * _responses(freq)
    dense = np.fft.irfft(passed, _N * _PER_SAMPLE, axis=2).reshape(-1, _N, _PER_SAMPLE)
    records = dense.transpose(0, 2, 1).reshape(-1, _N)
    shift = np.argmax(records, axis=1)[:, None] - _N // 2
    records = np.take_along_axis(records, (np.arange(_N) + shift) % _N, axis=1)
    widths = np.array([_half_width(record) for record in records])
    return widths, np.array([_lobes(smoothed(record)) for record in records])


def _responses(freq: Array) -> npt.NDArray[np.complex128]:
    """Frequency responses of the filters, (n_filters, n_freq); `freq` over the sampling rate."""
    rows: list[npt.NDArray[np.complex128]] = []
    for cutoff in _CUTOFFS:
        corner = 2.0 * np.pi * cutoff
        for b, a in (
            signal.ellip(7, 0.1, 80.0, corner, analog=True),
            signal.cheby1(8, 0.1, corner, analog=True),
            signal.butter(8, corner, analog=True),
        ):
            rows.append(np.asarray(signal.freqs(b, a, 2.0 * np.pi * freq)[1], dtype=np.complex128))
        fall = np.clip((freq - cutoff) / 0.08, 0.0, 1.0)
        rows.append((0.5 + 0.5 * np.cos(np.pi * fall)).astype(np.complex128))
    return np.array(rows)


def _half_width(record: Array) -> float:
    """Full width at half the peak, in samples, by straight lines."""
    half = 0.5 * record[_N // 2]
    left = _N // 2 - int(np.argmax(record[_N // 2 :: -1] < half))
    right = _N // 2 + int(np.argmax(record[_N // 2 :] < half))
    rise = left + (half - record[left]) / (record[left + 1] - record[left])
    fall = right - (half - record[right]) / (record[right - 1] - record[right])
    return float(fall - rise)


def _lobes(record: Array) -> Array:
    """Prominence over the peak of the largest lobe at least 1, 2, ... samples from it."""
    top = int(np.argmax(record))
    peaks, found = signal.find_peaks(record, prominence=1e-3 * record[top])
    lobes = np.zeros(_N)
    np.maximum.at(lobes, np.abs(peaks - top), found["prominences"] / record[top])
    lobes[0] = 0.0
    farther: Array = np.maximum.accumulate(lobes[::-1])[::-1]
    return farther[1 : REACH + 1]
