"""A small session of the Viper, made once: two postures and one held out for validation."""

from functools import cache

import numpy as np
from support.offline_lab import simulate_session

from armodal.analyzer.identification.identify import identify
from armodal.hil_sim.study.plant_of_arm import plant_of_arm
from armodal.protocols.arm.files import load_arm

STIFFER, MORE_DAMPED = 1.1, 1.3  # truth over the arm file's belief
HELD_OUT_DEG = (0.0, -163.1, 82.0, -119.5, 0.3, 0.5)
POSTURES = (
    ((0.0, -6.9, -29.0, -100.8, -113.0, -20.3), (0.7957, -0.1867, 0.5762)),
    ((0.0, -88.8, -12.7, -87.3, 10.1, 290.0), (-0.1628, 0.9834, -0.0801)),
    (HELD_OUT_DEG, (0.0713, 0.8704, 0.4872)),
)
HEAD = """format = "armodal-plan-1"
name = "small"
arm = "viper_s650"
mode = "roving-response"
fixed_point = "2"
hits_per_point = 2
max_attempts = 10
sampling = { rate_hz = 1024, samples = 2048, pretrigger = 64 }
trigger = { level_n = 10.0, slope = "rising" }
sensor = { mass_kg = 0.01 }
"""


def plan_text():
    text = HEAD
    for number, (angles, hit) in enumerate(POSTURES, start=1):
        text += (
            f'\n[[postures]]\nname = "test {number}"\njoints_deg = {list(angles)}\n'
            "tolerance_deg = 0.5\n"
            'points = ["1", "3", "5", "7", "9"]\n'
            f"hit_direction = {list(hit)}\n"
        )
    return text + "validation = true\n"


def true_values(arm):
    """Stiffness and damping of every joint of the simulated plant; None where rigid."""
    k = [STIFFER * j.stiffness.value if j.stiffness else None for j in arm.joints]
    c = [MORE_DAMPED * j.damping.value if j.damping else None for j in arm.joints]
    return k, c


@cache
def viper_session(folder):
    """Return the session; its plan is written into `folder`."""
    arm = load_arm("viper_s650")
    path = folder / "small.toml"
    path.write_text(plan_text())
    plant = plant_of_arm(arm, *true_values(arm))
    return simulate_session(1, plan=path, arm=arm, plant=plant)


@cache
def viper_result(folder):
    """Return what is identified from the session."""
    return identify(viper_session(folder))


def elastic_truth(arm):
    """True stiffness and damping of the elastic joints, as arrays."""
    k, c = true_values(arm)
    return np.array([v for v in k if v]), np.array([v for v in c if v])
