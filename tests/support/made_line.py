"""A line of a study, made up: a payload too small to be seen, and one further test.

`tests/study/test_curves.py` holds it against a line that a study wrote.
"""

STIFFNESS = {"joint": "joint_1", "k": 1.02e5, "std": 2e3, "low": 0.9e5, "high": 1.2e5, "true": 1e5}

MADE_LINE = {
    "number": 1,
    "arm": "ur5",
    "kinds": ["payload"],
    "magnitude": 0.05,
    "truth_sha256": "0" * 64,
    "tests": 1,
    "verdict": "nothing_detectable",
    "outcome": "missed",
    "named": [],
    "true": ["payload"],
    "n_true_named": 0,
    "standing": [],
    "places": [],
    "place_right": None,
    "true_verdict": "named",
    "misfit": 1.1,
    "replicas_leave": 1.4,
    "false_name_probability": 1.0,
    "confidence": 0.0,
    "cpu_s": 8.0,
    "pace": 1.0,
    "sizes": [],
    "stiffness": [STIFFNESS],
    "gap": [[0.2, 0.2, 0.05, False], [0.3, 0.3, 0.05, True]],
    "rivals": [],
    "over_true_model": 1.0,
    "stands_out": 1.01,
    "after": [
        {
            "words": "measure all points again, the arm stretched out",
            "why": "tells apart: nothing, or payload",
            "expected": 2.0,
            "verdict": "nothing_detectable",
            "outcome": "missed",
            "named": [],
        }
    ],
    "brought": {"asked": 1.0, "random": [0.5, 0.2, 0.1]},
    "widths": {"before": 0.3, "asked": 0.2, "random": 0.25},
}
