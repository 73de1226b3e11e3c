r"""How fast a device's clock runs, with bounds that hold whatever the delays were.

The ticks of round trip i were read between its sending :math:`s_i` and its arrival :math:`r_i`.
So for any two trips i before j the clock made :math:`n_j - n_i` ticks in no less than
:math:`s_j - r_i` and no more than :math:`r_j - s_i`, and the rate lies between

.. math:: \frac{n_j - n_i}{r_j - s_i} \le f \le \frac{n_j - n_i}{s_j - r_i}
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from armodal.daq.clock_fit import RoundTrip

__all__ = ["TickRate", "tick_rate"]

KNOWN_PPM = 1_000.0  # a clock known no better has not been checked


@dataclass(frozen=True, slots=True, kw_only=True)
class TickRate:
    """Tick rate against the host: nominal x (1 + `drift`), within `bound` of it.

    Not `steady`: no single rate agrees with all trips.
    """

    drift: float
    bound: float
    steady: bool

    @property
    def told(self) -> bool:
        """Whether the trips say enough of the clock: its rate, or that it has none."""
        return not self.steady or self.bound <= 1e-6 * KNOWN_PPM


def tick_rate(trips: Sequence[RoundTrip], *, nominal_tick_hz: float) -> TickRate:
    """Return the tick rate that all round trips allow.

    >>> trips = [RoundTrip(sent_s=t, received_s=t + 0.1, ticks=int(1000 * t) + 50) for t in (0, 10)]
    >>> rate = tick_rate(trips, nominal_tick_hz=1000.0)
    >>> rate.steady, round(rate.drift, 3), round(rate.bound, 3)
    (True, 0.0, 0.01)
    """
    origin = trips[0]
    ticks = np.array([trip.ticks - origin.ticks for trip in trips], dtype=np.float64)
    sent = np.array([trip.sent_s - origin.sent_s for trip in trips])
    received = np.array([trip.received_s - origin.sent_s for trip in trips])
    elapsed = (ticks[None, :] - ticks[:, None]) / nominal_tick_hz
    longest, shortest = received[None, :] - sent[:, None], sent[None, :] - received[:, None]
    apart = shortest > 0.0
    if not apart.any():
        return TickRate(drift=0.0, bound=np.inf, steady=True)
    low = float((elapsed[apart] / longest[apart]).max())
    high = float((elapsed[apart] / shortest[apart]).min())
    return TickRate(drift=0.5 * (low + high) - 1.0, bound=abs(high - low) / 2.0, steady=low <= high)
