"""A simulated plant for any arm, and an arm file for any URDF."""

import numpy as np
from scipy.spatial.transform import Rotation

from hil_sim.plant import build_plant, load_plant
from hil_sim.plant_file import LinkTruth, PointTruth


def plant_of_arm(arm, stiffness, damping, *, peak_n=(16.0, 24.0)):
    """The plant of an arm, its links' frames turned to lie as base does at q = 0.

    `stiffness` and `damping` hold a value or None for every joint. Hits are gentle, since a light
    wrist drives the accelerometer out of its range.
    """
    pattern = load_plant("rv4frl").truth
    T, before = np.eye(4), np.zeros(3)
    links, rotation = [], {"base": np.eye(3)}
    for joint, k, c in zip(arm.joints, stiffness, damping, strict=True):
        T = T @ joint.T_parent_joint
        R, link = T[:3, :3], joint.link
        rotation[link.name] = R
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
    return build_plant(
        pattern.model_copy(
            update={
                "name": arm.name,
                "links": tuple(links),
                "points": tuple(points),
                "hidden_axis": None,
                "hand": pattern.hand.model_copy(update={"peak_n": peak_n}),
            }
        )
    )


def arm_text_of_urdf(name, urdf_name, chain, *, n_elastic=3, seed=0):
    """An arm file for a URDF nobody tuned: guessed springs, four points round every link."""
    rng = np.random.default_rng(seed)
    lines = [
        'format = "armodal-arm-1"',
        f'name = "{name}"',
        'source = "a URDF as it is; springs guessed, points placed round the links"',
        f'urdf = "{urdf_name}"',
    ]
    for i, joint in enumerate(chain.joints):
        low, _ = joint.range_rad
        lines += ["[[joints]]", f'name = "{joint.name}"']
        if not np.isfinite(low):
            lines.append("range_deg = [-180.0, 180.0]")
        if i < n_elastic:
            lines.append(
                'stiffness_n_m_per_rad = { value = 15000.0, std = 5000.0, source = "guess" }'
            )
            lines.append('damping_n_m_s_per_rad = { value = 8.0, std = 4.0, source = "guess" }')
    number = 0
    for joint in chain.joints:
        for turn in range(3):
            number += 1
            R = Rotation.from_rotvec(2 * np.pi / 3 * turn * np.array([0, 0, 1.0])).as_matrix()
            place = joint.link.center_m + R @ np.array([0.05, 0.0, 0.04 * rng.uniform(-1, 1)])
            normal, x = R @ [1.0, 0, 0], np.array([0.0, 0, 1])
            lines += [
                "[[points]]",
                f'id = "{number}"',
                f'link = "{joint.link.name}"',
                f"position_m = {[round(float(v), 5) for v in place]}",
                f"normal = {[round(float(v), 4) for v in normal]}",
                f"x_axis = {[float(v) for v in x]}",
            ]
    lines += [
        "[tolerances]",
        "mass = 0.05\ninertia = 0.06\ncenter_m = 0.003\nencoder_offset_deg = 0.1",
        "sensor_tilt_deg = 0.5\nsensor_gain = 0.01\nhammer_gain = 0.01\nhit_direction_deg = 1.0",
    ]
    return "\n".join(lines) + "\n"
