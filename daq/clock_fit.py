r"""When did it happen? Host time of the device's ticks, from request and reply.

A round trip brackets one reading of the device clock between two of the host. Delays only ever
lengthen a trip, so the fastest trips are the truest: the straight line

.. math:: t = t_0 + a\,(n - n_0)

is fitted by least squares to the middles of the fastest fifth of them.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

__all__ = ["ClockFit", "ClockTracker", "RoundTrip", "fit_clock"]

FASTEST_SHARE = 0.2
FEWEST_FOR_A_SLOPE = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundTrip:
    """One request and its reply: host times around one reading of the device clock."""

    sent_s: float
    received_s: float
    ticks: int  # u64

    @property
    def duration_s(self) -> float:
        """Return how long the trip took, s."""
        return self.received_s - self.sent_s


@dataclass(frozen=True, slots=True, kw_only=True)
class ClockFit:
    """Host time as a straight line over device ticks.

    `scatter_s` is the standard deviation of the residuals, `asymmetry_s` what the unknown split
    of the fastest trip between way out and way back leaves open (uniform over half a trip).
    """

    reference_ticks: int
    reference_s: float
    s_per_tick: float
    scatter_s: float
    asymmetry_s: float
    n_used: int
    tick_spread: float  # root of the sum of squared tick distances from the reference

    def host_s(self, ticks: int) -> float:
        """Return the host time of `ticks`, s."""
        return self.reference_s + self.s_per_tick * (ticks - self.reference_ticks)

    def uncertainty_s(self, ticks: int) -> float:
        """Return the standard uncertainty of `host_s(ticks)`, s."""
        leverage = 1.0 / self.n_used
        if self.tick_spread > 0.0:
            leverage += ((ticks - self.reference_ticks) / self.tick_spread) ** 2
        return math.hypot(self.scatter_s * math.sqrt(leverage), self.asymmetry_s)


def fit_clock(trips: Sequence[RoundTrip], *, nominal_tick_hz: float) -> ClockFit:
    """Fit host time against device ticks over the fastest 20 % of `trips`.

    With fewer than four such trips, or all at one instant, the rate is the nominal one.

    Parameters
    ----------
    trips
        Round trips, in any order.
    nominal_tick_hz
        Tick rate the device declares, 1/s.

    Raises
    ------
    ValueError
        If there is no round trip.
    """
    if not trips:
        raise ValueError("clock fit: wanted at least one round trip, got none")
    kept = max(math.ceil(FASTEST_SHARE * len(trips)), min(len(trips), FEWEST_FOR_A_SLOPE))
    fastest = sorted(trips, key=lambda trip: trip.duration_s)[:kept]
    origin_ticks = fastest[0].ticks
    origin_s = fastest[0].sent_s
    # Differences of whole numbers first: a float holds 64-bit ticks only to 2^11.
    ticks = np.array([trip.ticks - origin_ticks for trip in fastest], dtype=np.float64)
    middles = np.array([0.5 * ((t.sent_s - origin_s) + (t.received_s - origin_s)) for t in fastest])
    mean_ticks = round(float(ticks.mean()))
    centred = ticks - mean_ticks
    spread2 = float(centred @ centred)
    slope = 1.0 / nominal_tick_hz
    fitted = 1
    if kept >= FEWEST_FOR_A_SLOPE and spread2 > 0.0:
        slope = float(centred @ (middles - middles.mean())) / spread2
        fitted = 2
    offset = float((middles - slope * centred).mean())
    residuals = middles - offset - slope * centred
    freedom = max(kept - fitted, 1)
    return ClockFit(
        reference_ticks=origin_ticks + mean_ticks,
        reference_s=origin_s + offset,
        s_per_tick=slope,
        scatter_s=math.sqrt(float(residuals @ residuals) / freedom),
        asymmetry_s=fastest[0].duration_s / math.sqrt(12.0),
        n_used=kept,
        tick_spread=math.sqrt(spread2) if fitted == 2 else 0.0,
    )


class ClockTracker:
    """The last round trips, and the line through the fastest of them."""

    def __init__(self, nominal_tick_hz: float, *, keep: int = 500) -> None:
        self._nominal_tick_hz = nominal_tick_hz
        self._trips: deque[RoundTrip] = deque(maxlen=keep)
        self._fit: ClockFit | None = None

    def add(self, trip: RoundTrip) -> None:
        """Take one round trip in."""
        self._trips.append(trip)
        self._fit = None

    def __len__(self) -> int:
        return len(self._trips)

    def fit(self) -> ClockFit:
        """Return the line through what has come so far; ValueError before the first trip."""
        if self._fit is None:
            self._fit = fit_clock(tuple(self._trips), nominal_tick_hz=self._nominal_tick_hz)
        return self._fit
