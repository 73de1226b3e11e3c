"""What a sensor feels per newton, over lines, gravity and its own mass counted."""

from __future__ import annotations

import numpy as np

from armodal.hil_sim.makers.arm_table import Array
from armodal.hil_sim.makers.frame.modal import GRAVITY_M_S2, Modal
from armodal.hil_sim.makers.frame.standing import Standing
from armodal.hil_sim.makers.frame.structure import Complex, Spot, cross

__all__ = ["felt_per_wrench", "wrench"]


def felt_per_wrench(
    standing: Standing,
    modes: Modal,
    s: Complex,
    sensors: list[Spot],
    hits: list[Spot],
    sensor_kg: float,
) -> list[Complex]:
    """Specific force felt at each sensor, world axes, per wrench at each hit: (lines, 3, hits, 6).

    The sensor's mass sits where it measures: x' = x - h m s^2 (1 + h m s^2)^-1 x with h the
    driving-point receptance there (Sherman, Morrison and Woodbury). It feels acceleration less
    gravity, and gravity turns in its axes as it turns.
    """
    structure = standing.structure
    left = [structure.motion(spot) for spot in sensors]
    right = [structure.motion(spot).T for spot in hits]
    own = [T[:3].T for T in left]
    moved = modes.receptance(s, np.vstack(left), np.hstack([*right, *own]))
    felt = []
    n_hits = 6 * len(hits)
    g = cross(GRAVITY_M_S2)
    square = (s**2)[:, None, None]
    for i in range(len(sensors)):
        rows = moved[:, 6 * i : 6 * i + 6]
        answer = rows[:, :, :n_hits]
        drive = rows[:, :, n_hits + 3 * i : n_hits + 3 * i + 3]
        if sensor_kg:
            load = (
                sensor_kg
                * square
                * np.linalg.solve(np.eye(3) + sensor_kg * square * drive[:, :3], answer[:, :3])
            )
            answer = answer - drive @ load
        turned: Complex = square * answer[:, :3] - g @ answer[:, 3:]
        felt.append(turned.reshape(len(s), 3, len(hits), 6))
    return felt


def wrench(direction: Array, off_m: Array) -> Array:
    """Wrench, (6,), of a newton along a direction, off its spot."""
    return np.concatenate([direction, np.cross(off_m, direction)])
