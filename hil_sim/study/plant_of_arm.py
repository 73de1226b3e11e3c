"""A plant for any arm file: its bodies and points, sensors of the shipped plant."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.plant import Plant, build_plant, load_plant
from armodal.hil_sim.plant_file import LinkTruth, PlantFile, PointTruth
from armodal.protocols.arm.records import Arm

__all__ = ["plant_file_of_arm", "plant_of_arm", "rotations"]

Array = npt.NDArray[np.float64]

PEAK_N = (16.0, 24.0)  # of a hand's good hits


def rotations(arm: Arm) -> dict[str, Array]:
    """(3, 3) for each link and the base: from the arm file's link frame to the plant's.

    The plant's frames lie as the base frame does while all joints are at zero.
    """
    result, R = {"base": np.eye(3)}, np.eye(3)
    for joint in arm.joints:
        R = R @ joint.T_parent_joint[:3, :3]
        result[joint.link.name] = R
    return result


def plant_of_arm(
    arm: Arm,
    stiffness: Sequence[float | None],
    damping: Sequence[float | None],
    *,
    sensor_kg: float | None = None,
) -> Plant:
    """Build the plant of an arm; `stiffness` and `damping` hold a value or None for every joint.

    `sensor_kg` is the accelerometer's mass; None: that of the shipped plant.
    """
    truth = plant_file_of_arm(arm, stiffness, damping, peak_n=PEAK_N)
    if sensor_kg is not None:
        sensor = truth.accelerometer.model_copy(update={"mass_kg": sensor_kg})
        truth = truth.model_copy(update={"accelerometer": sensor})
    return build_plant(truth)


def plant_file_of_arm(
    arm: Arm,
    stiffness: Sequence[float | None],
    damping: Sequence[float | None],
    *,
    peak_n: tuple[float, float],
) -> PlantFile:
    """Write the plant file of an arm, its links' frames turned to lie as base does at q = 0."""
    pattern = load_plant("rv4frl").truth
    rotation = rotations(arm)
    T, before = np.eye(4), np.zeros(3)
    links = []
    for joint, k, c in zip(arm.joints, stiffness, damping, strict=True):
        T = T @ joint.T_parent_joint
        R, link = T[:3, :3], joint.link
        inertia = R @ link.inertia_kg_m2 @ R.T
        axis = R @ joint.axis
        links.append(
            LinkTruth(
                name=link.name,
                joint=joint.name,
                origin_m=tuple(T[:3, 3] - before),
                axis=tuple(axis / np.linalg.norm(axis)),
                range_deg=tuple(np.rad2deg(joint.range_rad)),
                mass_kg=link.mass_kg,
                center_m=tuple(R @ link.center_m),
                inertia_kg_m2=tuple(inertia[np.triu_indices(3)]),
                stiffness_n_m_per_rad=k,
                damping_n_m_s_per_rad=c,
            )
        )
        before = T[:3, 3].copy()
    points = [
        PointTruth(
            id=point.id,
            link=point.link,
            position_m=tuple(rotation[point.link] @ point.position_m),
            normal=tuple((rotation[point.link] @ point.R_link_sensor)[:, 2]),
            x_axis=tuple((rotation[point.link] @ point.R_link_sensor)[:, 0]),
        )
        for point in arm.points
    ]
    return pattern.model_copy(
        update={
            "name": arm.name,
            "gravity_m_s2": tuple(arm.gravity_m_s2.tolist()),
            "links": tuple(links),
            "points": tuple(points),
            "hidden_axis": None,
            "hand": pattern.hand.model_copy(update={"peak_n": peak_n}),
        }
    )
