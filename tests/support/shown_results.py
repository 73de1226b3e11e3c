"""What `armodal gap --json` and `armodal identify --json` print, made up for the screens."""

GAP = {
    "verdict": "named",
    "summary": "The base rocks.",
    "effects": [
        {
            "name": "base",
            "title": "Base rocking",
            "place": "base",
            "parameters": {
                "rock_x": {
                    "unit": "N m/rad",
                    "value": 1.0e5,
                    "std": 5.1e3,
                    "low": 9.0e4,
                    "high": 1.1e5,
                }
            },
            "confidence": 0.97,
            "confused_with": ["Bearing soft across its axis"],
            "told_by": "a sensor on the base plate",
            "remedy": "Tighten the bolts.",
        },
        {
            "name": "link_axis",
            "title": "Link is compliant about an axis of its own",
            "place": "shoulder",
            "size": "axis compliance shoulder",
            "parameters": {
                "axis compliance shoulder": {
                    "unit": "rad/(N m)",
                    "value": 1.12e-5,
                    "std": 2.0e-7,
                    "low": 1.08e-5,
                    "high": 1.16e-5,
                },
                "axis loss shoulder": {
                    "unit": "s",
                    "value": 2.0e-4,
                    "std": 1.0e-5,
                    "low": 1.8e-4,
                    "high": 2.2e-4,
                },
            },
            "line": {"turned_rad": 0.001, "shifted_m": 0.002},
            "description": {
                "link": "shoulder",
                "direction": [0.96, 0.0, 0.28],
                "point_m": [-0.052, 0.018, 0.18],
            },
            "confidence": 0.9999,
            "confused_with": ["Bearing soft across its axis"],
        },
    ],
    "rivals": [
        {
            "name": "bearing",
            "place": "joint_1",
            "behind": 12.0,
            "false_name_probability": 0.03,
            "standing": False,
        }
    ],
    "gap_before": [{"posture": "test 1", "held_out": True, "frf_error": 0.4, "floor": 0.03}],
    "gap_after": [{"posture": "test 1", "held_out": True, "frf_error": 0.1, "floor": 0.03}],
    "joint_stiffness_ranges": [{"joint": "joint_1", "k_n_m_per_rad": 2e4, "low": 1e4, "high": 3e4}],
    "where": [
        {"posture": "test 1", "point": "7", "axis": "x", "band_hz": [3, 60], "ratio": 9.0},
        {"posture": "test 1", "point": "7", "axis": "y", "band_hz": [3, 60], "ratio": 2.0},
    ],
    "arm_file": "new.toml",
}

IDENTIFIED = {
    "joints": [
        {
            "joint": f"joint_{number}",
            "k_n_m_per_rad": 20_000.0 + number,
            "k_half_width_95": 15.0,
            "k_std_model": 600.0,
            "k_one_joint_n_m_per_rad": 19_500.0,
            "c_n_m_s_per_rad": 15.0,
            "c_std": 0.1,
        }
        for number in (1, 2, 3)
    ],
    "structural": [
        {
            "link": "shoulder",
            "k_n_m_per_rad": 89_210.0,
            "k_half_width_95": 240.0,
            "direction_link": [0.96, 0.0, 0.28],
            "point_link_m": [-0.052, 0.018, 0.18],
        }
    ],
    "validation": [
        {
            "posture": "validation 1",
            "mode": 1,
            "predicted_hz": 14.2,
            "predicted_std_hz": 0.02,
            "measured_hz": 14.3,
        }
    ],
    "notes": ["posture test 1: modes from poles picked by hand"],
}
