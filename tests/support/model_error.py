"""What a plant has wrong beside its arm file, and what the analysis is not told."""

import numpy as np

from hil_sim.plant import build_plant
from hil_sim.plant_file import PlantFile
from tests.support.any_arm import plant_of_arm

WEAK_BEARING = 1e-7  # rad / N m across each joint's axis
BEARING_LOSS_S = 2e-5  # damping / stiffness: a loss of 1.3 % at 100 Hz
HYSTERETIC_LOSS = 0.015


def true_springs(arm, rng):
    """Stiffness and damping of the joints, off the arm file's by 15 and 25 %; None where rigid."""
    k, c = [], []
    for joint in arm.joints:
        turn_k, turn_c = np.exp([0.15, 0.25] * np.clip(rng.standard_normal(2), -2.0, 2.0))
        elastic = joint.stiffness is not None
        k.append(float(joint.stiffness.value * turn_k) if elastic else None)
        # Part of the loss is hysteretic, so less of it is viscous.
        c.append(float(0.8 * joint.damping.value * turn_c) if elastic else None)
    return k, c


def wrong_link(link, rng):
    """A link's masses as the workshop made them: 5 % mass, 3 mm, 6 % inertia."""
    mass = 1.0 + 0.05 * _bounded(rng)
    xx, xy, xz, yy, yz, zz = link["inertia_kg_m2"]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    # Of the second moments every congruence is a body again.
    spread = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    turn = np.eye(3) + 0.02 * _bounded(rng, (3, 3))
    spread = (1.0 + 0.05 * _bounded(rng)) * turn @ spread @ turn.T
    inertia = np.trace(spread) * np.eye(3) - spread
    return link | {
        "mass_kg": float(link["mass_kg"] * mass),
        "center_m": tuple((np.array(link["center_m"]) + 0.003 * _bounded(rng, 3)).tolist()),
        "inertia_kg_m2": tuple(inertia[np.triu_indices(3)].tolist()),
    }


def background(joints, elastic, rng):
    """Weak modes, hysteretic damping, encoders and skew: effects too small to be named."""
    effects = []
    for name in joints:
        k = 1.0 / (WEAK_BEARING * np.exp(0.3 * _bounded(rng, 2)))
        effects.append(
            {
                "kind": "bearing",
                "joint": name,
                "stiffness_n_m_per_rad": tuple(k.tolist()),
                "damping_n_m_s_per_rad": tuple((BEARING_LOSS_S * k).tolist()),
            }
        )
        effects.append(
            {
                "kind": "encoder_offset",
                "joint": name,
                "offset_deg": float(0.15 * _bounded(rng)),
            }
        )
    effects.append(
        {
            "kind": "hysteretic",
            "joints": tuple(elastic),
            "loss_factor": float(HYSTERETIC_LOSS * np.exp(0.3 * _bounded(rng))),
        }
    )
    skew_s = 10e-6 * _bounded(rng)
    late = ("hammer",) if skew_s > 0.0 else ("acc_x", "acc_y", "acc_z")
    effects.append({"kind": "delay", "channels": late, "delay_s": float(abs(skew_s) + 1e-9)})
    return effects


def erring_plant_tables(arm, rng, *, peak_n):
    """All of a plant file as tables: the arm with every ordinary error and no named effect."""
    k, c = true_springs(arm, rng)
    tables = plant_of_arm(arm, k, c, peak_n=peak_n).truth.model_dump()
    tables["links"] = [wrong_link(link, rng) for link in tables["links"]]
    gains = np.eye(3) + np.diag(0.01 * _bounded(rng, 3)) + 0.003 * _bounded(rng, (3, 3))
    tables["accelerometer"] |= {
        "response": tuple(map(tuple, gains.tolist())),
        "mount_tilt_deg": 0.87,  # about each of three axes: 1.5 degrees in all
    }
    tables["hammer"] |= {"gain_error": float(0.01 * _bounded(rng))}
    tables["hand"] |= {"direction_std_deg": 1.0, "position_std_m": 0.002}
    joints = [joint.name for joint in arm.joints]
    elastic = [joint.name for joint in arm.joints if joint.stiffness is not None]
    tables["effects"] = background(joints, elastic, rng)
    return tables


def plant_of_tables(tables):
    """The plant of the tables, read as strictly as from a file."""
    return build_plant(PlantFile.model_validate(tables))


def _bounded(rng, shape=None):
    """Normal numbers, none beyond 2.5."""
    return np.clip(rng.standard_normal(shape), -2.5, 2.5)
