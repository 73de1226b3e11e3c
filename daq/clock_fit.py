r"""When did it happen? Host time of the device's ticks, from request and reply.

A round trip brackets one reading of the device clock between two of the host. Delays only ever
lengthen a trip, so the fastest trips are the truest: the straight line

.. math:: t = t_0 + a\,(n - n_0)

is fitted by least squares to the middles of the fastest fifth of them. The fifth is taken from
each tenth of the time by itself: a quiet moment, with many fast trips close together, would
otherwise be all there is to fit a rate to.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["ClockFit", "ClockTracker", "RoundTrip", "fit_clock"]

FASTEST_SHARE = 0.2
SEGMENTS = 10
FEWEST = 4
NOMINAL_RATE_STD = 1e-4  # relative: a plain crystal, over temperature
SLOW = 10.0  # times the median: a trip that took so long was held up, and tells nothing
JUMP_S = 0.005  # beyond its uncertainties, a clock that is so far off has jumped
CERTAIN = 5.0  # standard uncertainties


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
    of the trips used between way out and way back leaves open (uniform over the median trip).
    """

    reference_ticks: int
    reference_s: float
    s_per_tick: float
    scatter_s: float
    asymmetry_s: float
    n_used: int
    s_per_tick_std: float

    def host_s(self, ticks: int) -> float:
        """Return the host time of `ticks`, s."""
        return self.reference_s + self.s_per_tick * (ticks - self.reference_ticks)

    def uncertainty_s(self, ticks: int) -> float:
        """Return the standard uncertainty of `host_s(ticks)`, s."""
        return math.hypot(
            self.scatter_s / math.sqrt(self.n_used),
            self.s_per_tick_std * (ticks - self.reference_ticks),
            self.asymmetry_s,
        )


def fit_clock(trips: Sequence[RoundTrip], *, nominal_tick_hz: float) -> ClockFit:
    """Fit host time against device ticks over the fastest 20 % of `trips`.

    Where the trips tell the rate worse than the device itself does (to 100 ppm), as at the
    beginning of a session, the rate is the nominal one.

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
    fastest = _fastest(trips)
    origin_ticks = fastest[0].ticks
    origin_s = fastest[0].sent_s
    # Differences of whole numbers first: a float holds 64-bit ticks only to 2^11.
    ticks = np.array([trip.ticks - origin_ticks for trip in fastest], dtype=np.float64)
    middles = np.array([0.5 * ((t.sent_s - origin_s) + (t.received_s - origin_s)) for t in fastest])
    mean_ticks = round(float(ticks.mean()))
    centred = ticks - mean_ticks
    spread2 = float(centred @ centred)
    n = len(fastest)
    slope = 1.0 / nominal_tick_hz
    slope_std = slope * NOMINAL_RATE_STD
    if n >= FEWEST and spread2 > 0.0:
        fitted = float(centred @ (middles - middles.mean())) / spread2
        fitted_std = _scatter(centred, middles, fitted, 2) / math.sqrt(spread2)
        if fitted_std < slope_std:
            slope, slope_std = fitted, fitted_std
    return ClockFit(
        reference_ticks=origin_ticks + mean_ticks,
        reference_s=origin_s + float((middles - slope * centred).mean()),
        s_per_tick=slope,
        scatter_s=_scatter(centred, middles, slope, 2),
        asymmetry_s=float(np.median([trip.duration_s for trip in fastest])) / math.sqrt(12.0),
        n_used=n,
        s_per_tick_std=slope_std,
    )


def _fastest(trips: Sequence[RoundTrip]) -> list[RoundTrip]:
    """Return the fastest trips of each tenth of the time; of a few trips, the fastest four."""
    first = min(trip.ticks for trip in trips)
    span = max(trip.ticks for trip in trips) - first + 1
    segments: dict[int, list[RoundTrip]] = {}
    for trip in sorted(trips, key=lambda trip: trip.duration_s):
        segments.setdefault(SEGMENTS * (trip.ticks - first) // span, []).append(trip)
    chosen = [
        trip
        for segment in segments.values()
        for trip in segment[: math.ceil(FASTEST_SHARE * len(segment))]
    ]
    median_s = float(np.median([trip.duration_s for trip in chosen]))
    chosen = [trip for trip in chosen if trip.duration_s <= SLOW * median_s]
    if len(chosen) >= FEWEST:
        return chosen
    return sorted(trips, key=lambda trip: trip.duration_s)[:FEWEST]


def _scatter(
    centred: npt.NDArray[np.float64], middles: npt.NDArray[np.float64], slope: float, fitted: int
) -> float:
    residuals = middles - slope * centred
    residuals = residuals - residuals.mean()
    return math.sqrt(float(residuals @ residuals) / max(len(residuals) - fitted, 1))


class ClockTracker:
    """The last round trips, and the line through the fastest of them.

    Device time lies between the host's two times of a round trip, whatever the delays. Where the
    line contradicts that, the device's clock has jumped, and the earlier trips are forgotten.

    Attributes
    ----------
    jumped_s : float
        Host time when the last jump was noticed; minus infinity while there was none.
    seen_s : float
        Host time when the last trip began.
    """

    def __init__(self, nominal_tick_hz: float, *, keep: int = 500) -> None:
        self._nominal_tick_hz = nominal_tick_hz
        self._trips: deque[RoundTrip] = deque(maxlen=keep)
        self._fit: ClockFit | None = None
        self.jumped_s = -math.inf
        self.seen_s = -math.inf

    def add(self, trip: RoundTrip) -> bool:
        """Take one round trip in; return whether it shows that the clock has jumped."""
        jumped = bool(self._trips) and self._contradicts(trip)
        if jumped:
            self._trips.clear()
            self.jumped_s = trip.received_s
        self._trips.append(trip)
        self._fit = None
        self.seen_s = max(self.seen_s, trip.sent_s)
        return jumped

    def _contradicts(self, trip: RoundTrip) -> bool:
        fit = self.fit()
        told_s = fit.host_s(trip.ticks)
        slack_s = JUMP_S + CERTAIN * fit.uncertainty_s(trip.ticks)
        return not trip.sent_s - slack_s <= told_s <= trip.received_s + slack_s

    def __len__(self) -> int:
        return len(self._trips)

    def fit(self) -> ClockFit:
        """Return the line through what has come so far; ValueError before the first trip."""
        if self._fit is None:
            self._fit = fit_clock(tuple(self._trips), nominal_tick_hz=self._nominal_tick_hz)
        return self._fit
