r"""What the anti-alias filter of a board makes of one narrow pulse, taken off the record.

A steep low-pass rings at its cut-off, 0.3 to 0.5 of the sampling rate, after a narrow pulse, and
before it too if its phase is linear: lobes of up to 20 % of the peak that no second pulse made. A
board does not say which filter it has, so the record is compared with a bank of templates: pulses
of half to six samples, sine and sine squared, at eight positions between the samples, through
elliptic, Chebyshev, Butterworth, Bessel and linear-phase filters cut off at 0.30 to 0.50. The
template nearest to the seven samples about the peak predicts the lobes outside them, and is
subtracted.

What is left lies mostly near the cut-off. The kernel (1, 2, 1)/4 has the gain
:math:`\cos^2(\pi f / f_s)`, 35 % at 0.3 and 10 % at 0.4 of the rate. For pulses too wide to make
a filter ring much, (1, 4, 6, 4, 1)/16, its square, is enough without a template.

References
----------
Filters: Oppenheim and Schafer, Discrete-Time Signal Processing, 3rd ed. (2010), ch. 7 and app. B.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt
import scipy

__all__ = ["COMPARED", "NARROW_KERNEL", "WIDE_KERNEL", "templates", "without_narrow_pulse"]

Array = npt.NDArray[np.float64]

NARROW_KERNEL: Array = np.array([1.0, 2.0, 1.0]) / 4.0
WIDE_KERNEL: Array = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16.0
COMPARED = 3  # samples from the peak, to either side

_N = 128  # samples of a template, its peak in the middle
_POSITIONS = 8
_WIDTHS = (0.5, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0)
_CUTOFFS = tuple(0.30 + 0.02 * k for k in range(11))
_FALL = 0.08  # transition of the linear-phase filters, over the sampling rate
_FINE = 24  # grid points a sample on which pulses are drawn


def without_narrow_pulse(force: Array, peak_at: int) -> Array:
    """Force less the template nearest to it within three samples of its peak.

    Parameters
    ----------
    force : (n,)
        Force about zero between pulses.
    peak_at
        Its highest sample.

    Returns
    -------
    (n,) float64
        Within those seven samples, what no template explains; beyond them, other pulses and noise.
    """
    bank = templates()
    middle = _N // 2
    first, last = max(peak_at - COMPARED, 0), min(peak_at + COMPARED + 1, len(force))
    part = force[first:last]
    near = bank[:, middle + first - peak_at : middle + last - peak_at]
    energy = np.einsum("ij,ij->i", near, near)
    scale = near @ part / energy
    best = int(np.argmax(scale**2 * energy))  # least squares: what the template takes away
    first, last = max(peak_at - middle, 0), min(peak_at + middle, len(force))
    rest = force.copy()
    rest[first:last] -= scale[best] * bank[best, middle + first - peak_at : middle + last - peak_at]
    return rest


@lru_cache(maxsize=1)
def templates() -> Array:
    """Recorded pulses of unit peak, (n_templates, _N)."""
    t = np.arange(_FINE * _N) / _FINE - _N / 2
    x = np.clip(t / np.array(_WIDTHS)[:, None] + 0.5, 0.0, 1.0)
    pulses = np.concatenate([np.sin(np.pi * x), np.sin(np.pi * x) ** 2])
    freq = np.arange(2 * _N) / _N  # over the sampling rate; nothing passes beyond twice of it
    spectra = np.fft.rfft(pulses, axis=1)[:, : len(freq)]
    passed = spectra[:, None, :] * _responses(freq)
    dense = np.fft.irfft(passed, _N * _POSITIONS, axis=2).reshape(-1, _N, _POSITIONS)
    records = dense.transpose(0, 2, 1).reshape(-1, _N)
    shift = np.argmax(records, axis=1)[:, None] - _N // 2
    records = np.take_along_axis(records, (np.arange(_N) + shift) % _N, axis=1)
    unit: Array = records / records[:, _N // 2, None]
    unit.flags.writeable = False
    return unit


def _responses(freq: Array) -> npt.NDArray[np.complex128]:
    """Frequency responses of the filters, (n_filters, n_freq); `freq` over the sampling rate."""
    rows: list[npt.NDArray[np.complex128]] = []
    for cutoff in _CUTOFFS:
        corner = 2.0 * np.pi * cutoff
        for b, a in (
            scipy.signal.ellip(7, 0.1, 80.0, corner, analog=True),
            scipy.signal.ellip(9, 0.3, 100.0, corner, analog=True),
            scipy.signal.cheby1(8, 0.1, corner, analog=True),
            scipy.signal.butter(8, corner, analog=True),
            scipy.signal.bessel(6, corner, analog=True, norm="mag"),
        ):
            response = scipy.signal.freqs(b, a, 2.0 * np.pi * freq)[1]
            rows.append(np.asarray(response, dtype=np.complex128))
        fall = np.clip((freq - cutoff) / _FALL, 0.0, 1.0)
        rows.append((0.5 + 0.5 * np.cos(np.pi * fall)).astype(np.complex128))
    return np.array(rows)
