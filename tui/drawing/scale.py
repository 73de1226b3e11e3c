"""Scales of axes: linear or logarithmic, with round ticks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Scale", "linear_scale", "log_scale", "tick_text"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """Values from `low` to `high` along an axis, low < high; both above zero when logarithmic."""

    low: float
    high: float
    log: bool = False

    def share(self, values: npt.ArrayLike) -> Array:
        """Place of values along the axis, 0 at low and 1 at high; NaN where a log has none."""
        v = np.asarray(values, dtype=np.float64)
        if not self.log:
            return (v - self.low) / (self.high - self.low)
        safe = np.log(np.where(v > 0.0, v, np.nan))
        low, high = np.log(self.low), np.log(self.high)
        return np.asarray((safe - low) / (high - low), dtype=np.float64)

    def value(self, share: float) -> float:
        """Value at a place along the axis."""
        if self.log:
            return float(self.low * (self.high / self.low) ** share)
        return float(self.low + share * (self.high - self.low))

    def holds(self, values: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Return which values lie on the axis."""
        v = np.asarray(values, dtype=np.float64)
        return np.asarray((v >= self.low) & (v <= self.high), dtype=np.bool_)

    def places(self, values: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Return which values have a place at all, on the axis or beyond its ends."""
        v = np.asarray(values, dtype=np.float64)
        return np.asarray(np.isfinite(v) & ((v > 0.0) | (not self.log)), dtype=np.bool_)

    def zoomed(self, factor: float, about: float) -> Scale:
        """Return the scale `factor` times as fine about a value that keeps its place."""
        at = float(self.share(about))
        return Scale(
            low=self.value(at - at / factor),
            high=self.value(at + (1.0 - at) / factor),
            log=self.log,
        )

    def ticks(self, about: int) -> tuple[float, ...]:
        """About that many round values, 1, 2, 5 times powers of ten; decades when logarithmic."""
        if self.log:
            first, last = np.log10(self.low), np.log10(self.high)
            step = max(int(np.ceil((last - first) / max(about, 1))), 1)
            decades = np.arange(np.ceil(first - 1e-9), np.floor(last + 1e-9) + 1, step)
            if decades.size >= 2:
                return tuple(float(10.0**d) for d in decades)
        span = (self.high - self.low) / max(about, 1)
        power = 10.0 ** np.floor(np.log10(span))
        step_size = next(power * m for m in (1, 2, 5, 10) if power * m >= span * (1 - 1e-9))
        count = np.arange(
            np.ceil(self.low / step_size - 1e-9), np.floor(self.high / step_size + 1e-9) + 1
        )
        return tuple(float(round(n * step_size, 12)) for n in count)


def linear_scale(
    *values: npt.ArrayLike, floor: float | None = None, least_span: float = 0.0
) -> Scale:
    """Scale that holds all finite `values`, and `floor`, with a little room.

    `least_span` keeps a nearly constant trace from being blown up to the frame.
    """
    found = [v[np.isfinite(v)] for v in (np.asarray(a, dtype=np.float64).ravel() for a in values)]
    every = np.concatenate([*found, [] if floor is None else [floor]])
    low, high = (float(every.min()), float(every.max())) if every.size else (0.0, 1.0)
    if high - low < least_span:
        middle = (low + high) / 2
        low, high = middle - least_span / 2, middle + least_span / 2
    if high <= low:
        room = 0.5 * max(abs(high), 1.0) if least_span <= 0.0 else least_span
        low, high = low - room, high + room
    return Scale(low=low, high=high)


def log_scale(*values: npt.ArrayLike, most_decades: float = 6.0) -> Scale:
    """Logarithmic scale of all positive finite `values`, at most `most_decades` from the top."""
    found = [np.asarray(a, dtype=np.float64).ravel() for a in values]
    every = np.concatenate([v[np.isfinite(v) & (v > 0.0)] for v in found] or [np.zeros(0)])
    if not every.size:
        return Scale(low=0.1, high=1.0, log=True)
    high = float(every.max()) * 1.1
    low = max(float(every.min()) * 0.9, high * 10.0**-most_decades)
    return Scale(low=low, high=high, log=True)


def tick_text(value: float) -> str:
    """Tick as short text: 0.01, 1e-5, 250, 12k.

    >>> [tick_text(v) for v in (0.0, 1e-5, 0.02, 3.0, 250.0, 12000.0, 1e6)]
    ['0', '1e-5', '0.02', '3', '250', '12k', '1e6']
    """
    if value == 0.0:
        return "0"
    size = abs(value)
    if size < 1e-3 or size >= 1e6:
        mantissa, exponent = f"{value:.0e}".split("e")
        return f"{mantissa}e{int(exponent)}"
    if size >= 1e4:
        return f"{value / 1e3:.6g}k"
    return f"{value:.6g}"
