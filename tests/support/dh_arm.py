"""Arms by rows of modified DH parameters, with bodies that are good enough for kinematics."""

from armodal.protocols.arm.files import arm_from_texts


def dh_arm(rows, *, name="by-rows"):
    """An arm of rows (alpha in deg, a in m, d in m), its joints called axis 1 and so on."""
    lines = ['format = "armodal-arm-1"', f'name = "{name}"', 'source = "rows of a data sheet"']
    for i, (alpha, a, d) in enumerate(rows, 1):
        row = f"alpha_deg = {float(alpha)}, a_m = {float(a)}, d_m = {float(d)}"
        body = f'name = "link {i}", mass_kg = 2.0, center_m = [0.01, 0.0, 0.05]'
        lines += [
            "[[joints]]",
            f'name = "axis {i}"',
            "range_deg = [-360.0, 360.0]",
            f"dh = {{ {row}, theta_offset_deg = 0.0 }}",
            f"link = {{ {body}, inertia_kg_m2 = [0.02, 0.02, 0.01, 0.0, 0.0, 0.0] }}",
        ]
    lines += [
        "[[points]]",
        'id = "1"',
        f'link = "link {len(rows)}"',
        "position_m = [0.0, 0.0, 0.1]",
        "normal = [0.0, 0.0, 1.0]",
        "x_axis = [1.0, 0.0, 0.0]",
        "[tolerances]",
        "mass = 0.05\ninertia = 0.06\ncenter_m = 0.003\nencoder_offset_deg = 0.1",
        "sensor_tilt_deg = 0.5\nsensor_gain = 0.01\nhammer_gain = 0.01\nhit_direction_deg = 1.0",
    ]
    text = "\n".join(lines) + "\n"
    return arm_from_texts(text, urdf_text=None, database_text=None)
