"""What a plant has wrong beside its arm file, and what the analysis is not told."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.plant import Plant, build_plant
from armodal.hil_sim.plant_file import PlantFile
from armodal.hil_sim.study.arms import StudyArm
from armodal.hil_sim.study.plant_of_arm import plant_file_of_arm
from armodal.protocols.arm.records import Arm

__all__ = ["Tables", "erring_plant_tables", "plant_of_tables"]

Array = npt.NDArray[np.float64]
Tables = dict[str, Any]

WEAK_BEARING = 0.0064  # across each joint's axis, as part of the arm's own joint compliance
LARGEST_WEAK_BEARING = 2e-7  # rad / N m
BEARING_LOSS_S = 2e-5  # damping / stiffness: a loss of 1.3 % at 100 Hz
HYSTERETIC_LOSS = 0.015
OVERSAMPLING = 8  # a force linear between grid points is 0.02 % short at 100 Hz
STIFFNESS_STD, DAMPING_STD = 0.15, 0.25  # of the true springs' logarithm, against the arm file


def erring_plant_tables(study: StudyArm, rng: np.random.Generator) -> Tables:
    """All of a plant file as tables: the arm with every ordinary error and no named effect.

    Springs 15 % and dampers 25 % off the arm file, masses 5 %, centres 3 mm, inertias 5 %, sensors
    tilted by 1.5 degrees in all and 1 % in gain, hits off aim by 1 degree and 2 mm, encoders 0.15
    degrees, 10 us of skew, weak transverse bearings, a part of the damping hysteretic.
    """
    arm = study.arm
    k, c = _true_springs(arm, rng)
    tables = plant_file_of_arm(arm, k, c, peak_n=study.peak_n).model_dump()
    tables["links"] = [_wrong_link(link, rng) for link in tables["links"]]
    gains = np.eye(3) + np.diag(0.01 * _bounded(rng, 3)) + 0.003 * _bounded(rng, (3, 3))
    tables["accelerometer"] |= {
        "response": tuple(map(tuple, gains.tolist())),
        "mount_tilt_deg": 0.87,  # about each of three axes: 1.5 degrees in all
    }
    tables["board"] |= {"oversampling": OVERSAMPLING}
    tables["hammer"] |= {"gain_error": float(0.01 * _bounded(rng, ()))}
    tables["hand"] |= {
        "direction_std_deg": 1.0,
        "position_std_m": 0.002,
        "double_probability": 0.0,
        "soft_probability": 0.0,
        "overload_probability": 0.0,
    }
    tables["effects"] = _background(study, rng)
    return tables


def plant_of_tables(tables: Tables) -> Plant:
    """Build the plant of the tables, read as strictly as from a file."""
    return build_plant(PlantFile.model_validate(tables))


def _true_springs(
    arm: Arm, rng: np.random.Generator
) -> tuple[list[float | None], list[float | None]]:
    """Stiffness and damping of the joints; None where rigid."""
    k: list[float | None] = []
    c: list[float | None] = []
    for joint in arm.joints:
        turns = np.exp(np.array([STIFFNESS_STD, DAMPING_STD]) * _bounded(rng, 2, 2.0))
        if joint.stiffness is None or joint.damping is None:
            k.append(None)
            c.append(None)
            continue
        k.append(float(joint.stiffness.value * turns[0]))
        # Part of the loss is hysteretic, so less of it is viscous.
        c.append(float(0.8 * joint.damping.value * turns[1]))
    return k, c


def _wrong_link(link: Tables, rng: np.random.Generator) -> Tables:
    """A link's masses as the workshop made them."""
    mass = 1.0 + 0.05 * float(_bounded(rng, (), 2.0))
    xx, xy, xz, yy, yz, zz = link["inertia_kg_m2"]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    # Of the second moments every congruence is a body again.
    spread = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    turn = np.eye(3) + 0.02 * _bounded(rng, (3, 3))
    spread = (1.0 + 0.05 * float(_bounded(rng, ()))) * turn @ spread @ turn.T
    inertia = np.trace(spread) * np.eye(3) - spread
    return link | {
        "mass_kg": float(link["mass_kg"] * mass),
        "center_m": tuple((np.array(link["center_m"]) + 0.003 * _bounded(rng, 3)).tolist()),
        "inertia_kg_m2": tuple(inertia[np.triu_indices(3)].tolist()),
    }


def _background(study: StudyArm, rng: np.random.Generator) -> list[Tables]:
    """Weak modes, hysteretic damping, encoders and skew: effects too small to be named."""
    effects: list[Tables] = []
    weak = min(WEAK_BEARING * study.joint_compliance, LARGEST_WEAK_BEARING)
    for joint in study.arm.joints:
        k = 1.0 / (weak * np.exp(0.3 * _bounded(rng, 2)))
        effects.append(
            {
                "kind": "bearing",
                "joint": joint.name,
                "stiffness_n_m_per_rad": tuple(k.tolist()),
                "damping_n_m_s_per_rad": tuple((BEARING_LOSS_S * k).tolist()),
            }
        )
        offset = float(0.15 * _bounded(rng, ()))
        effects.append({"kind": "encoder_offset", "joint": joint.name, "offset_deg": offset})
    elastic = tuple(joint.name for joint in study.arm.joints if joint.stiffness is not None)
    loss = float(HYSTERETIC_LOSS * np.exp(0.3 * _bounded(rng, ())))
    effects.append({"kind": "hysteretic", "joints": elastic, "loss_factor": loss})
    skew_s = float(10e-6 * _bounded(rng, ()))
    late = ("hammer",) if skew_s > 0.0 else ("acc_x", "acc_y", "acc_z")
    effects.append({"kind": "delay", "channels": late, "delay_s": abs(skew_s) + 1e-9})
    return effects


def _bounded(rng: np.random.Generator, shape: int | tuple[int, ...], bound: float = 2.5) -> Array:
    """Normal numbers, none beyond the bound."""
    return np.clip(np.asarray(rng.standard_normal(shape)), -bound, bound)
