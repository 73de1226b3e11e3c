"""White and slow noise of the board's channels."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy

from armodal.hil_sim.front_end import FrontEnd
from armodal.hil_sim.plant_file import PlantFile
from armodal.hil_sim.sensing import CHANNELS
from armodal.hil_sim.streams import Streams

__all__ = ["ChannelNoise", "white_noise"]

Array = npt.NDArray[np.float64]

SLOW_HZ = 1.0  # corner of the low pass that slow noise has come through


class ChannelNoise:
    """Noise of hammer and accelerometer in counts, the same however `read` is divided."""

    def __init__(self, truth: PlantFile, front: FrontEnd, streams: Streams) -> None:
        hammer, sensor = truth.hammer, truth.accelerometer
        self._white_counts = front.counts_per_unit * [hammer.noise_n, *(sensor.noise_m_s2,) * 3]
        self._slow_counts = front.counts_per_unit * [hammer.flicker_n, *(sensor.flicker_m_s2,) * 3]
        self._white = [streams("white noise", channel) for channel in CHANNELS]
        self._slow = [streams("slow noise", channel) for channel in CHANNELS]
        rate_hz = front.fine_hz / front.oversampling
        self._keep = float(np.exp(-2.0 * np.pi * SLOW_HZ / rate_hz))
        # The sensors have been on for long.
        self._state = self._keep * white_noise(self._slow, 1)

    def read(self, n: int) -> Array:
        """Return the next (n, 4) counts, not rounded."""
        if n == 0:  # lfilter leaves the state undefined
            return np.zeros((0, len(CHANNELS)))
        drive = np.sqrt(1.0 - self._keep**2) * white_noise(self._slow, n)
        slow, self._state = scipy.signal.lfilter(
            [1.0], [1.0, -self._keep], drive, axis=0, zi=self._state
        )
        counts: Array = white_noise(self._white, n) * self._white_counts + slow * self._slow_counts
        return counts


def white_noise(channels: list[np.random.Generator], n: int) -> Array:
    """Normal numbers (n, n_channels), each column from its channel's stream."""
    return np.column_stack([rng.standard_normal(n) for rng in channels])
