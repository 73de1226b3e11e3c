"""What a plant has wrong beside its arm file, and what the analysis is not told."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.plant import Plant, build_plant
from armodal.hil_sim.plant_file import PlantFile
from armodal.hil_sim.streams import Streams, stream
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


def erring_plant_tables(study: StudyArm, seed: int) -> Tables:
    """All of a plant file as tables: the arm with every ordinary error and no named effect.

    Springs 15 % and dampers 25 % off the arm file, masses 5 %, centres 3 mm, inertias 5 %, sensors
    tilted by 1.5 degrees in all and 1 % in gain, hits off aim by 1 degree and 2 mm, encoders 0.15
    degrees, 10 us of skew, weak transverse bearings, a part of the damping hysteretic. Each error
    has a stream of its own, named by what errs.
    """
    arm, streams = study.arm, partial(stream, seed, "model error")
    k, c = _true_springs(arm, streams)
    tables = plant_file_of_arm(arm, k, c, peak_n=study.peak_n).model_dump()
    tables["links"] = [_wrong_link(link, streams) for link in tables["links"]]
    gains = np.array([_gains(axis, streams) for axis in "xyz"])
    tables["accelerometer"] |= {
        "response": tuple(map(tuple, gains.tolist())),
        "mount_tilt_deg": 0.87,  # about each of three axes: 1.5 degrees in all
    }
    tables["board"] |= {"oversampling": OVERSAMPLING}
    tables["hammer"] |= {"gain_error": 0.01 * _one(streams("hammer gain"))}
    tables["hand"] |= {
        "direction_std_deg": 1.0,
        "position_std_m": 0.002,
        "double_probability": 0.0,
        "soft_probability": 0.0,
        "overload_probability": 0.0,
    }
    tables["effects"] = _background(study, streams)
    return tables


def plant_of_tables(tables: Tables) -> Plant:
    """Build the plant of the tables, read as strictly as from a file."""
    return build_plant(PlantFile.model_validate(tables))


def _true_springs(arm: Arm, streams: Streams) -> tuple[list[float | None], list[float | None]]:
    """Stiffness and damping of the joints; None where rigid."""
    k: list[float | None] = []
    c: list[float | None] = []
    for joint in arm.joints:
        if joint.stiffness is None or joint.damping is None:
            k.append(None)
            c.append(None)
            continue
        off = STIFFNESS_STD * _one(streams("stiffness", joint.name), 2.0)
        k.append(joint.stiffness.value * math.exp(off))
        # Part of the loss is hysteretic, so less of it is viscous.
        off = DAMPING_STD * _one(streams("damping", joint.name), 2.0)
        c.append(0.8 * joint.damping.value * math.exp(off))
    return k, c


def _gains(axis: str, streams: Streams) -> Array:
    """(3,) of a channel of the accelerometer for specific force along each of its axes."""
    row = 0.003 * _bounded(streams("cross talk", axis), 3)
    row["xyz".index(axis)] += 1.0 + 0.01 * _one(streams("gain", axis))
    return row


def _wrong_link(link: Tables, streams: Streams) -> Tables:
    """A link's masses as the workshop made them."""
    name = link["name"]
    mass = 1.0 + 0.05 * _one(streams("mass", name), 2.0)
    center = np.array(link["center_m"]) + 0.003 * _bounded(streams("center", name), 3)
    xx, xy, xz, yy, yz, zz = link["inertia_kg_m2"]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    # Of the second moments every congruence is a body again.
    spread = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    turn = np.eye(3) + 0.02 * _bounded(streams("inertia axes", name), (3, 3))
    spread = (1.0 + 0.05 * _one(streams("inertia", name))) * turn @ spread @ turn.T
    inertia = np.trace(spread) * np.eye(3) - spread
    return link | {
        "mass_kg": float(link["mass_kg"] * mass),
        "center_m": tuple(center.tolist()),
        "inertia_kg_m2": tuple(inertia[np.triu_indices(3)].tolist()),
    }


def _background(study: StudyArm, streams: Streams) -> list[Tables]:
    """Weak modes, hysteretic damping, encoders and skew: effects too small to be named."""
    effects: list[Tables] = []
    weak = min(WEAK_BEARING * study.joint_compliance, LARGEST_WEAK_BEARING)
    for joint in study.arm.joints:
        k = 1.0 / (weak * np.exp(0.3 * _bounded(streams("bearing", joint.name), 2)))
        effects.append(
            {
                "kind": "bearing",
                "joint": joint.name,
                "stiffness_n_m_per_rad": tuple(k.tolist()),
                "damping_n_m_s_per_rad": tuple((BEARING_LOSS_S * k).tolist()),
            }
        )
        offset = 0.15 * _one(streams("encoder offset", joint.name))
        effects.append({"kind": "encoder_offset", "joint": joint.name, "offset_deg": offset})
    elastic = tuple(joint.name for joint in study.arm.joints if joint.stiffness is not None)
    loss = HYSTERETIC_LOSS * math.exp(0.3 * _one(streams("hysteretic")))
    effects.append({"kind": "hysteretic", "joints": elastic, "loss_factor": loss})
    skew_s = 10e-6 * _one(streams("skew"))
    late = ("hammer",) if skew_s > 0.0 else ("acc_x", "acc_y", "acc_z")
    effects.append({"kind": "delay", "channels": late, "delay_s": abs(skew_s) + 1e-9})
    return effects


def _bounded(rng: np.random.Generator, shape: int | tuple[int, ...], bound: float = 2.5) -> Array:
    """Normal numbers, none beyond the bound."""
    return np.clip(rng.standard_normal(shape), -bound, bound)


def _one(rng: np.random.Generator, bound: float = 2.5) -> float:
    return float(_bounded(rng, (), bound))
