"""A UR10e with springs so soft that its six modes lie in the band, and sessions of it."""

import dataclasses

import numpy as np

from armodal.hil_sim.makers import make_case
from armodal.hil_sim.plant import build_plant
from armodal.hil_sim.plant_file import HiddenAxisTruth
from armodal.hil_sim.study.any_arm import rehearsal_plan, study_of
from armodal.hil_sim.study.measure import measured
from armodal.hil_sim.study.plant_of_arm import plant_file_of_arm

BELIEVED = (21_000.0, 23_000.0, 14_000.0, 2_500.0, 1_500.0, 75.0)  # N m/rad
MODE_HZ = (12.0, 12.0, 20.0, 40.0, 50.0, 80.0)  # of 2 % damping, roughly each joint's own
OFF = 0.15  # of the true springs' logarithm
AXIS = HiddenAxisTruth(
    link="shoulder",
    point_m=(0.02, 0.03, 0.05),
    direction=(1.0, 0.2, 0.29),
    stiffness_n_m_per_rad=60_000.0,
    damping_n_m_s_per_rad=6.0,
)


def soft_ur10e():
    """The arm as believed: a maker's UR10e with softer springs."""
    arm = make_case("frame", 1, "ur10e", None, wrist="elastic").arm
    joints = []
    for joint, k, f_hz in zip(arm.joints, BELIEVED, MODE_HZ, strict=True):
        c = 2 * 0.02 * k / (2 * np.pi * f_hz)
        joints.append(
            dataclasses.replace(
                joint,
                stiffness=dataclasses.replace(joint.stiffness, value=k, std=0.3 * k),
                damping=dataclasses.replace(joint.damping, value=c, std=0.5 * c),
            )
        )
    return dataclasses.replace(arm, joints=tuple(joints))


def soft_ur10e_session(axis, seed):
    """A session of the arm with true springs off, and the true stiffnesses."""
    arm, rng = soft_ur10e(), np.random.default_rng(seed)
    k = [j.stiffness.value * np.exp(OFF * rng.standard_normal()) for j in arm.joints]
    c = [j.damping.value * np.exp(OFF * rng.standard_normal()) for j in arm.joints]
    plan = rehearsal_plan(arm)
    truth = plant_file_of_arm(arm, k, c, peak_n=study_of(arm, plan).peak_n)
    sure = {f"{name}_probability": 0.0 for name in ("double", "soft", "overload")}
    hand = truth.hand.model_copy(update=sure)
    plant = build_plant(truth.model_copy(update={"hand": hand, "hidden_axis": axis}))
    return measured(plant, arm, plan, seed), k
