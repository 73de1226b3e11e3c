"""An arm whose every sample is a closed form of its index and the hits: no dynamics, no luck."""

from dataclasses import dataclass

import numpy as np
from support.synthetic_laboratory import truth

from armodal.hil_sim.plant_file import PlantFile

PULSE_SAMPLES = 8
RING_COUNTS = 300_000
RING_DOWN_SAMPLES = 25.0
RING_PERIODS = (17.0, 23.0, 31.0)
AHEAD = 4096  # samples whose noise is made at once
NOISE_COUNTS = 401  # noise is this many counts wide


@dataclass(frozen=True)
class KnownBlow:
    peak_counts: int


def known_truth() -> PlantFile:
    return truth()


def hash_noise(first, n, salt):
    """Counts (n, 4) that look random, differ from sample to sample and from run to run."""
    index = np.arange(first, first + n, dtype=np.uint64)[:, None] * np.uint64(4)
    index = index + np.arange(4, dtype=np.uint64)
    index += np.uint64(salt * 0x9E3779B97F4A7C15 % 2**64)
    index ^= index >> np.uint64(31)
    index *= np.uint64(0xBF58476D1CE4E5B9)
    index ^= index >> np.uint64(27)
    return (index % np.uint64(NOISE_COUNTS)).astype(np.int64) - NOISE_COUNTS // 2


class KnownArm:
    """A source of samples for `hil_sim.cell.Cell`."""

    def __init__(self, salt):
        self._salt = salt
        self._first = 0
        self._hits = []
        self._noise = hash_noise(0, 0, salt)
        self._noise_first = 0  # sample that it begins with

    def set_posture(self, joints_rad):
        """The samples do not depend on it."""

    def mount(self, point_id):
        """The samples do not depend on it."""

    def set_moving(self, moving):
        """The samples do not depend on it."""

    def strike(self, at_sample, blow):
        self._hits.append((at_sample, blow))

    def read(self, n):
        begin = self._first - self._noise_first
        if begin + n > len(self._noise):
            # Much at once: an array of four samples takes as long to make.
            self._noise, self._noise_first = (
                hash_noise(self._first, n + AHEAD, self._salt),
                self._first,
            )
            begin = 0
        counts = with_hits(self._noise[begin : begin + n], self._first, self._hits)
        self._first += n
        return counts


def known_counts(first, n, hits, salt):
    """Counts (n, 4) of hammer and accelerometer from sample `first` on."""
    return with_hits(hash_noise(first, n, salt), first, hits)


def with_hits(noise, first, hits):
    """Counts whose noise, from sample `first` on, is given."""
    n = len(noise)
    near = [hit for hit in hits if first - 40 * RING_DOWN_SAMPLES < hit[0] < first + n]
    if not near:
        return noise.astype(np.int32)
    index = np.arange(first, first + n, dtype=np.float64)
    counts = noise.astype(np.float64)
    for at, blow in near:
        since = index - at
        during = (since > 0.0) & (since < PULSE_SAMPLES)
        counts[during, 0] += blow.peak_counts * np.sin(np.pi * since[during] / PULSE_SAMPLES)
        after = since > 0.0
        decay = RING_COUNTS * np.exp(-since[after] / RING_DOWN_SAMPLES)
        for channel, period in enumerate(RING_PERIODS, start=1):
            counts[after, channel] += decay * np.sin(2.0 * np.pi * since[after] / period)
    return np.round(counts).astype(np.int32)
