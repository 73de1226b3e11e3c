"""Arms of any number of joints, written as arm files: rows of turning and lifting joints."""

from armodal.protocols.arm.files import arm_from_texts


def chain_arm_text(n_joints, *, n_elastic=None, gravity=(0.0, 0.0, -9.80665), name=None):
    """An arm file of `n_joints`, the first upright, links of 0.25 m with three points each."""
    n_elastic = n_joints if n_elastic is None else n_elastic
    lines = [
        'format = "armodal-arm-1"',
        f'name = "{name or f"chain{n_joints}"}"',
        'source = "made for tests"',
        f"gravity_m_s2 = {list(gravity)}",
    ]
    for i in range(n_joints):
        alpha = 0.0 if i == 0 else 90.0 if i % 2 else -90.0
        mass = 6.0 * 0.75**i
        inertia = [0.02 * mass, 0.015 * mass, 0.01 * mass, 0.0, 0.0, 0.0]
        joint_range = "[-150.0, 150.0]" if i != 1 else "[-140.0, -5.0]"
        a, d = 0.06 * (i % 2), 0.25 if i % 2 == 0 else 0.0
        row = f"alpha_deg = {alpha}, a_m = {a}, theta_offset_deg = 0.0, d_m = {d}"
        body = f'name = "link {i + 1}", mass_kg = {mass:.4f}, center_m = [0.02, 0.01, 0.05]'
        lines += [
            "[[joints]]",
            f'name = "axis {i + 1}"',
            f"range_deg = {joint_range}",
            f"dh = {{ {row} }}",
            f"link = {{ {body}, inertia_kg_m2 = {[round(v, 6) for v in inertia]} }}",
        ]
        if i < n_elastic:
            k = 20000.0 * 0.6**i
            for key, value, part in (
                ("stiffness_n_m_per_rad", k, 0.3),
                ("damping_n_m_s_per_rad", 4e-4 * k, 0.5),
            ):
                std = part * value
                lines.append(f'{key} = {{ value = {value:.4f}, std = {std:.4f}, source = "g" }}')
    number = 0
    for i in range(n_joints):
        for place, normal, x in (
            ([0.06, 0.0, 0.05], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ([0.0, 0.06, 0.1], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
            ([0.02, -0.05, 0.02], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]),
        ):
            number += 1
            lines += [
                "[[points]]",
                f'id = "{number}"',
                f'link = "link {i + 1}"',
                f"position_m = {place}",
                f"normal = {normal}",
                f"x_axis = {x}",
            ]
    lines += [
        "[tolerances]",
        "mass = 0.05\ninertia = 0.06\ncenter_m = 0.003\nencoder_offset_deg = 0.1",
        "sensor_tilt_deg = 0.5\nsensor_gain = 0.01\nhammer_gain = 0.01\nhit_direction_deg = 1.0",
    ]
    return "\n".join(lines) + "\n"


def chain_arm(n_joints, **settings):
    """The arm of `chain_arm_text`."""
    return arm_from_texts(chain_arm_text(n_joints, **settings), urdf_text=None, database_text=None)
