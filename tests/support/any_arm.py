"""An arm file for any URDF."""

import numpy as np
from scipy.spatial.transform import Rotation


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
