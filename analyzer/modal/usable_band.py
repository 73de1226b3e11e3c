"""The band a hammer excites, by the spectrum of its force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["UsableBand", "usable_band"]

_LOWEST_HZ = 3.0  # or less, where a record holds so many periods of less
_PERIODS = 16.0  # in which a mode of 2 % damping falls to an eighth
_HIGHEST_OF_RATE = 0.39  # anti-alias filters of 24-bit boards are flat to about here
_LEAST_FORCE = 0.02  # of the force spectrum's maximum: 34 dB below


@dataclass(frozen=True, slots=True, kw_only=True)
class UsableBand:
    """Where FRFs are taken if no band is asked for; `limit` says what ends it."""

    low_hz: float
    high_hz: float
    limit: str
    by_force: bool = False  # whether the force ends it, not the board

    @property
    def words(self) -> str:
        """Return what is used where no band is asked for, and why no more."""
        return (
            f"FRFs from {self.low_hz:.4g} to {self.high_hz:.5g} Hz: above, {self.limit}; below, "
            "drift and AC coupling; "
            "`armodal fit --band` takes other lines"
        )

    def widened(self, band_hz: tuple[float, float]) -> tuple[float, float] | None:
        """Return the band that holds the lines asked for too; None if this one does."""
        low, high = band_hz
        if low >= self.low_hz and high <= self.high_hz:
            return None
        return min(low, self.low_hz), max(high, self.high_hz)

    def warning(self, band_hz: tuple[float, float]) -> str:
        """Return a sentence about the lines asked for outside of this band; empty without."""
        low, high = band_hz
        parts = []
        if high > self.high_hz * (1.0 + 1e-9):
            parts.append(f"above {self.high_hz:.5g} Hz {self.limit}")
        if low < self.low_hz:
            parts.append(f"below {self.low_hz:.4g} Hz drift and AC coupling are larger than motion")
        if not parts:
            return ""
        return (
            f"the band {low:g} to {high:g} Hz was asked for: {' and '.join(parts)}; look at the "
            "coherence there"
        )


def usable_band(
    freq_hz: npt.NDArray[np.float64], force: npt.NDArray[np.float64], rate_hz: float
) -> UsableBand:
    """Return the band that hits excite.

    Parameters
    ----------
    freq_hz
        (n_freq,) of the record's lines.
    force
        (n_hits, n_freq) magnitude of the force spectra.
    rate_hz
        Sampling rate.

    Returns
    -------
    UsableBand
        From 3 Hz, or what a longer record holds 16 periods of, to 0.39 of the sampling rate, or to
        where the median force first falls below 2 % of its maximum above 3 Hz.
    """
    top_hz = _HIGHEST_OF_RATE * rate_hz
    typical = np.median(force, axis=0)
    low_hz = min(_LOWEST_HZ, _PERIODS * float(freq_hz[1] - freq_hz[0]))
    above = freq_hz > _LOWEST_HZ  # an offset and drift are no hit
    weak = above & (typical < _LEAST_FORCE * np.max(typical, initial=0.0, where=above))
    end_hz = float(freq_hz[int(np.argmax(weak))]) * (1.0 - 1e-12) if np.any(weak) else np.inf
    if end_hz < top_hz:
        limit = f"the force is below {100 * _LEAST_FORCE:.0f} % of its spectrum's maximum"
        return UsableBand(low_hz=low_hz, high_hz=end_hz, limit=limit, by_force=True)
    limit = "an anti-alias filter may not be flat"
    return UsableBand(low_hz=low_hz, high_hz=top_hz, limit=limit)
