"""What the noise of a log's angles alone would make an accelerometer read.

Drives that follow logged angles turn their noise into acceleration, more with the square of
frequency. What is left above the band, where no drive follows, is taken as white and as going on
through the band.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.workspace.batch import ArmBatch
from armodal.protocols.arm.files import BASE
from armodal.protocols.arm.records import Arm

__all__ = ["read_by_noise"]

Array = npt.NDArray[np.float64]

_ABOVE = 0.42  # of the rate: where nothing but noise is left
_ROWS = 256  # of a segment of the spectrum
_LOOKED = 8  # postures that levers are taken from


def read_by_noise(
    arm: Arm, angles_rad: Array, rate_hz: float, band_hz: tuple[float, float], point: str
) -> float:
    """Root mean square that noise of the angles makes a sensor read in a band, m/s², three axes.

    Parameters
    ----------
    angles_rad : (n, n_joints)
        Evenly apart.
    """
    still = scipy.signal.detrend(angles_rad, axis=0)
    f, power = scipy.signal.welch(still, fs=rate_hz, nperseg=min(_ROWS, len(still)), axis=0)
    floor = np.median(power[f > _ABOVE * rate_hz], axis=0)  # (n_joints,) rad²/Hz
    low, high = (2.0 * np.pi * edge for edge in band_hz)
    turning = floor * (high**5 - low**5) / (5.0 * 2.0 * np.pi)  # (rad/s²)²
    some = angles_rad[:: max(1, len(angles_rad) // _LOOKED)]
    return float(np.sqrt((turning * _levers(arm, some, point) ** 2).sum()))


def _levers(arm: Arm, joints_rad: Array, point_id: str) -> Array:
    """(n_joints,) a point's longest lever about each joint's axis; 0 of joints beyond it."""
    point = arm.point(point_id)
    found = np.zeros(len(arm.joints))
    if point.link == BASE:
        return found
    link = [joint.link.name for joint in arm.joints].index(point.link)
    batch = ArmBatch(arm)
    origin, axis = batch.joint_axes(joints_rad)
    place = batch.position(joints_rad, link, point.position_m)
    reach = np.linalg.norm(np.cross(axis, place[None] - origin, axis=1), axis=1).max(axis=1)
    found[: link + 1] = reach[: link + 1]
    return found
