"""What a plant has wrong beside its arm file, and what the analysis is not told."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.plant import Plant, build_plant
from armodal.hil_sim.plant_file import PlantFile
from armodal.hil_sim.streams import Streams, stream
from armodal.hil_sim.study.arms import StudyArm, compliance_of
from armodal.hil_sim.study.plant_of_arm import plant_file_of_arm
from armodal.protocols.arm.records import Arm

__all__ = ["Tables", "erring_plant_tables", "plant_of_tables"]

Array = npt.NDArray[np.float64]
Tables = dict[str, Any]

# Ranges are drawn by their logarithm. Compliances are parts of those of the drives that are there.
WEAK_BEARING = (0.0008, 0.0235)  # across each joint's axis, of its own drive's
NOT_RIGID = (0.0004, 0.019)  # about the axis of a joint believed rigid
SOFT_FLOOR = (0.00015, 0.0085)  # rocking of the base
FLOOR_SHIFT_M2 = (0.002, 0.05)  # m / N of shifting per rad / N m of rocking
BASE_MASS = (0.05, 0.6)  # of the arm's
INTERFACE_LOSS_S = (4e-6, 6e-4)  # damping / stiffness: a loss of 0.25 to 38 % at 100 Hz
HYSTERETIC_LOSS = (0.0025, 0.045)  # of each joint
HAND_M = (0.0008, 0.005)  # scatter of where a hit lands
OVERSAMPLING = 8  # a force linear between grid points is 0.02 % short at 100 Hz
STIFFNESS_STD, DAMPING_STD = 0.15, 0.25  # of the true springs' logarithm, against the arm file


def erring_plant_tables(study: StudyArm, seed: int) -> Tables:
    """All of a plant file as tables: the arm with every ordinary error and no named effect.

    Springs 15 % and dampers 25 % off the arm file, masses 5 %, centres 3 mm, inertias 5 %, sensors
    tilted by 1.5 degrees in all and 1 % in gain, hits off aim by 1 degree and some mm, encoders by
    0.15 degrees, 10 us of skew; bearings, joints believed rigid and the floor give way a little,
    and a part of the damping is hysteretic, each as much as a stream of its own says.
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
        "position_std_m": _between(HAND_M, streams("hand")),
        "double_probability": 0.0,
        "soft_probability": 0.0,
        "overload_probability": 0.0,
    }
    tables["effects"] = _background(study, k, streams)
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


def _background(study: StudyArm, springs: Sequence[float | None], streams: Streams) -> list[Tables]:
    """Weak modes, hysteretic damping, encoders and skew: effects too small to be named."""
    compliance = compliance_of([k for k in springs if k is not None])
    effects: list[Tables] = [_floor(study, compliance, streams)]
    for joint, stiffness in zip(study.arm.joints, springs, strict=True):
        name = joint.name
        drive = compliance if stiffness is None else 1.0 / stiffness
        weak = _between(WEAK_BEARING, streams("bearing", name))
        sides = weak * np.exp(0.3 * _bounded(streams("bearing sides", name), 2))
        k = 1.0 / (drive * np.clip(sides, *WEAK_BEARING))
        loss_s = _between(INTERFACE_LOSS_S, streams("bearing loss", name))
        effects.append(
            {
                "kind": "bearing",
                "joint": name,
                "stiffness_n_m_per_rad": tuple(k.tolist()),
                "damping_n_m_s_per_rad": tuple((loss_s * k).tolist()),
            }
        )
        offset = 0.15 * _one(streams("encoder offset", name))
        effects.append({"kind": "encoder_offset", "joint": name, "offset_deg": offset})
        if joint.stiffness is None:
            k_axis = 1.0 / (compliance * _between(NOT_RIGID, streams("not rigid", name)))
            effects.append(
                {
                    "kind": "released_joint",
                    "joint": name,
                    "stiffness_n_m_per_rad": k_axis,
                    "damping_n_m_s_per_rad": loss_s * k_axis,
                }
            )
        else:
            loss = _between(HYSTERETIC_LOSS, streams("hysteretic", name))
            effects.append({"kind": "hysteretic", "joints": (name,), "loss_factor": loss})
    skew_s = 10e-6 * _one(streams("skew"))
    late = ("hammer",) if skew_s > 0.0 else ("acc_x", "acc_y", "acc_z")
    effects.append({"kind": "delay", "channels": late, "delay_s": abs(skew_s) + 1e-9})
    return effects


def _floor(study: StudyArm, compliance: float, streams: Streams) -> Tables:
    """The base on a floor that gives way a little."""
    rock = compliance * _between(SOFT_FLOOR, streams("floor"))
    shift = rock * _between(FLOOR_SHIFT_M2, streams("floor shift"))
    mass = sum(j.link.mass_kg for j in study.arm.joints) * _between(BASE_MASS, streams("base mass"))
    loss_s = _between(INTERFACE_LOSS_S, streams("floor loss"))
    ways = {f"shift_{axis}": 1.0 / shift for axis in "xyz"}
    ways |= {f"rock_{axis}": 1.0 / rock for axis in "xyz"}
    return {
        "kind": "base",
        "pivot_m": (0.0, 0.0, 0.0),
        "mass_kg": mass,
        "center_m": (0.0, 0.0, 0.06),
        "inertia_kg_m2": (0.01 * mass, 0.0, 0.0, 0.01 * mass, 0.0, 0.015 * mass),
        "springs": tuple(
            {"way": way, "stiffness": k, "damping": loss_s * k} for way, k in ways.items()
        ),
    }


def _between(ends: tuple[float, float], rng: np.random.Generator) -> float:
    """Drawn evenly by its logarithm."""
    low, high = np.log(ends)
    return float(np.exp(rng.uniform(low, high)))


def _bounded(rng: np.random.Generator, shape: int | tuple[int, ...], bound: float = 2.5) -> Array:
    """Normal numbers, none beyond the bound."""
    return np.clip(rng.standard_normal(shape), -bound, bound)


def _one(rng: np.random.Generator, bound: float = 2.5) -> float:
    return float(_bounded(rng, (), bound))
