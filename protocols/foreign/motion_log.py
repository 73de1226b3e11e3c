"""A log of motion: joint angles, and what accelerometers at test points read, evenly apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ForeignFileError

__all__ = ["FEWEST_ROWS", "MotionLog", "check_motion"]

Array = npt.NDArray[np.float64]

FEWEST_ROWS = 200  # the narrowest filter takes some ten of them
_BEYOND_RAD = 0.05  # that an arm may overrun its range
_ONE_G = (0.9, 1.1)  # mean length of a reading at rest that is counted in g; 9.81 in m/s^2


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionLog:
    """n rows, evenly apart."""

    rate_hz: float
    slowest_hz: float  # rate of what was logged least often: the rest between is a curve
    encoder_rad: Array | None  # (n, n_joints); None unless every joint has one
    command_rad: Array | None  # likewise
    acceleration_m_s2: dict[str, Array]  # by test point, (n, 3) in the sensor's axes
    unused: tuple[str, ...]  # columns or topics
    notes: tuple[str, ...] = ()

    @property
    def angles_rad(self) -> Array:
        """Return the joints' angles: of the encoders, or as commanded."""
        found = self.command_rad if self.encoder_rad is None else self.encoder_rad
        if found is None:
            raise ValueError("wanted encoder or command angles, got neither")
        return found


def check_motion(log: MotionLog, origin: str, arm: Arm) -> MotionLog:
    """Return a log whose values can be what they are said to be.

    Raises
    ------
    ForeignFileError
        If joints stand where they cannot, or accelerometers count in g; all are named.
    """
    faults = [
        fault
        for angles in (log.encoder_rad, log.command_rad)
        if angles is not None
        for fault in _beyond(angles, arm)
    ]
    for point, values in log.acceleration_m_s2.items():
        size = float(np.linalg.norm(values.mean(axis=0)))
        if _ONE_G[0] < size < _ONE_G[1]:
            faults.append(
                f"m/s² at point {point}, got readings whose mean is {size:.2f} long, which is "
                "gravity in g"
            )
    if faults:
        raise ForeignFileError(
            f"{origin}: wanted {'; '.join(faults)}; give angles of the joints as the arm file "
            "counts them, in the units that docs/simulators.md names"
        )
    return log


def _beyond(angles: Array, arm: Arm) -> list[str]:
    """Angles in another unit are mostly where the joints cannot be."""
    found = []
    for joint, own in zip(arm.joints, angles.T, strict=True):
        low, high = joint.range_rad
        if own.min() < low - _BEYOND_RAD or own.max() > high + _BEYOND_RAD:
            seen, limits = np.rad2deg([own.min(), own.max()]), np.rad2deg([low, high])
            found.append(
                f"{joint.name} within {limits[0]:.4g} to {limits[1]:.4g} deg, got {seen[0]:.4g} to "
                f"{seen[1]:.4g}"
            )
    return found
