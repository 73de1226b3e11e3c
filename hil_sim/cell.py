"""The test cell: the arm with its sensor and hammer, which board, controller and operator share."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Generic, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array

__all__ = ["Cell", "Source"]

BlowT_contra = TypeVar("BlowT_contra", contravariant=True)
BlowT = TypeVar("BlowT")


class Source(Protocol[BlowT_contra]):
    """The arm seen through the board's converter; `hil_sim.source.SensorSource` is one."""

    def set_posture(self, joints_rad: npt.NDArray[np.float64]) -> None:
        """Put the arm at rest in a posture."""

    def mount(self, point_id: str) -> None:
        """Put the accelerometer on a test point."""

    def set_moving(self, moving: bool) -> None:
        """Tell whether the drives move the arm."""

    def strike(self, at_sample: float, blow: BlowT_contra) -> None:
        """Add a hit that begins at a sample index, fractions allowed."""

    def read(self, n: int) -> npt.NDArray[np.int32]:
        """Return the next (n, n_channels) counts."""


class Cell(Generic[BlowT]):
    """What is where: posture, sensor, and the samples since the board was started.

    Parameters
    ----------
    make_source
        Makes the source for a sample rate, at rest.
    joints_rad : (n_joints,)
        Posture at first.
    point
        Test point that carries the sensor at first.
    """

    def __init__(
        self,
        make_source: Callable[[Fraction], Source[BlowT]],
        *,
        joints_rad: npt.ArrayLike,
        point: str,
    ) -> None:
        self._make_source = make_source
        self._source: Source[BlowT] | None = None
        self.joints_rad = frozen_array(joints_rad, np.float64)
        self.point = point
        self.moving = False
        self.next_sample = 0
        self.rate_hz: Fraction | None = None

    @property
    def sampling(self) -> bool:
        """Whether the converter runs."""
        return self._source is not None

    def start_sampling(self, rate_hz: Fraction) -> None:
        """Begin again at sample 0."""
        source = self._make_source(rate_hz)
        source.set_posture(self.joints_rad)
        source.mount(self.point)
        source.set_moving(self.moving)
        self._source, self.rate_hz, self.next_sample = source, rate_hz, 0

    def stop_sampling(self) -> None:
        """Let the converter rest."""
        self._source = self.rate_hz = None

    def read(self, n: int) -> npt.NDArray[np.int32]:
        """Return the next (n, n_channels) counts; the converter must run."""
        if self._source is None:
            raise RuntimeError("the converter does not run: start_sampling comes first")
        self.next_sample += n
        return self._source.read(n)

    def set_moving(self) -> None:
        """The arm has left its posture."""
        self.moving = True
        if self._source is not None:
            self._source.set_moving(True)

    def set_posture(self, joints_rad: npt.ArrayLike) -> None:
        """The arm has come to rest."""
        self.joints_rad = frozen_array(joints_rad, np.float64)
        self.moving = False
        if self._source is not None:
            self._source.set_posture(self.joints_rad)
            self._source.set_moving(False)

    def mount(self, point: str) -> None:
        """The sensor sits on another point."""
        self.point = point
        if self._source is not None:
            self._source.mount(point)

    def strike(self, delay_samples: float, blow: BlowT) -> float | None:
        """Hit the arm some samples from now; return the sample index, None if none is taken."""
        if self._source is None:
            return None
        at_sample = self.next_sample + delay_samples
        self._source.strike(at_sample, blow)
        return at_sample
