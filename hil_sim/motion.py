"""How the arm gets from one posture to the next: all joints together, with minimum jerk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array

__all__ = ["Motion"]

# Largest speed of the minimum-jerk profile as a multiple of distance / duration: 30/16.
PEAK_SPEED_FACTOR = 1.875


@dataclass(frozen=True, slots=True)
class Motion:
    """Joint angles over lab time, from rest to rest.

    References
    ----------
    Flash and Hogan, J. Neurosci. 5 (1985) 1688, Eq. (3).
    """

    start_rad: npt.NDArray[np.float64]
    goal_rad: npt.NDArray[np.float64]
    begin_s: float
    duration_s: float

    @classmethod
    def plan(
        cls,
        start_rad: npt.ArrayLike,
        goal_rad: npt.ArrayLike,
        *,
        begin_s: float,
        max_speed_rad_s: float,
    ) -> Motion:
        """Plan a motion in which the fastest joint just reaches `max_speed_rad_s`."""
        start, goal = frozen_array(start_rad, np.float64), frozen_array(goal_rad, np.float64)
        distance = float(np.max(np.abs(goal - start), initial=0.0))
        return cls(start, goal, begin_s, PEAK_SPEED_FACTOR * distance / max_speed_rad_s)

    @property
    def end_s(self) -> float:
        """Lab time at which the goal is reached."""
        return self.begin_s + self.duration_s

    def moving(self, lab_s: float) -> bool:
        """Whether the arm moves at `lab_s`."""
        return self.begin_s <= lab_s < self.end_s

    def joints_rad(self, lab_s: float) -> npt.NDArray[np.float64]:
        """(n_joints,) joint angles at `lab_s`."""
        if lab_s >= self.end_s:
            return self.goal_rad
        if lab_s <= self.begin_s:
            return self.start_rad
        s = (lab_s - self.begin_s) / self.duration_s
        part = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        return self.start_rad + part * (self.goal_rad - self.start_rad)
