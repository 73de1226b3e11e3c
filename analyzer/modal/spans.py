"""A long record in pieces that can be searched one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.noise import smooth_lines

__all__ = ["Span", "spans"]

LINES = 4096  # of a span, about: the search's time grows with the square of the modes in it
OVERLAP = 4  # of the span lies on either side of it, a part in so many


@dataclass(frozen=True, slots=True, kw_only=True)
class Span:
    """Lines searched together, and the part of them whose modes are the span's own."""

    first: int
    last: int
    low_hz: float  # own from here
    high_hz: float  # to below here

    def holds(self, f_hz: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Whether frequencies are in the span's own part."""
        result: npt.NDArray[np.bool_] = (f_hz >= self.low_hz) & (f_hz < self.high_hz)
        return result


def spans(
    freq_hz: npt.NDArray[np.float64],
    values: npt.NDArray[np.complex128],
    variance: npt.NDArray[np.float64],
) -> list[Span]:
    """Cut where the FRFs are weakest, into spans of about as many lines.

    Parameters
    ----------
    freq_hz
        (n_freq,).
    values, variance
        (n_long, n_short, n_freq).
    """
    n = freq_hz.size
    count = max(round(n / LINES), 1)
    if count == 1:
        return [Span(first=0, last=n - 1, low_hz=0.0, high_hz=np.inf)]
    power = np.sum(np.abs(values) ** 2 / variance, axis=(0, 1))
    level = smooth_lines(power, LINES // 64)
    cuts = [0]
    for k in range(1, count):
        middle, reach = k * n // count, n // count // OVERLAP
        cuts.append(middle - reach + int(np.argmin(level[middle - reach : middle + reach])))
    cuts.append(n)
    beside = n // count // OVERLAP
    edges = [0.0, *(float(freq_hz[cut]) for cut in cuts[1:-1]), np.inf]
    return [
        Span(
            first=max(cuts[k] - beside, 0),
            last=min(cuts[k + 1] + beside, n) - 1,
            low_hz=edges[k],
            high_hz=edges[k + 1],
        )
        for k in range(count)
    ]
