"""Effects that are in no library, hidden at their clear size times a magnitude."""

from __future__ import annotations

import numpy as np

from armodal.hil_sim.effects.hidden import Hidden, about, hidden, loss_s, plain, unit
from armodal.hil_sim.study.places import ArmPlaces

__all__ = ["dress_pack", "one_sided", "parallelogram_bar"]

PACK = 0.045  # of the arm's mass
CRACK = 0.8  # open, of the arm's joint compliance
BAR = 0.6  # of the far joint's stiffness, where bar and tail are square

Rng = np.random.Generator


def dress_pack(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A hanging bundle of hoses."""
    link = list(places.links)[2 if rng.random() < 0.5 else 3]
    arm_kg = sum(link["mass_kg"] for link in places.links.values())
    mass = float(PACK * arm_kg * magnitude * about(rng))
    hertz = float(rng.uniform(9.0, 40.0))
    table = {
        "kind": "dress_pack",
        "link": link,
        "position_m": plain(places.somewhere(rng, link)),
        "mass_kg": mass,
        "frequency_hz": hertz,
        "damping_ratio": float(rng.uniform(0.04, 0.15)),
    }
    return hidden("dress_pack", link, table, mass_kg=mass, frequency_hz=hertz)


def one_sided(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A crack or a bolt that opens a little beside rest."""
    link = str(rng.choice(places.structural()[:4]))
    opened = 1.0 / (CRACK * places.compliance * magnitude * about(rng))
    table = {
        "kind": "one_sided",
        "link": link,
        "point_m": plain(places.somewhere(rng, link)),
        "direction": plain(unit(rng)),
        "stiffness_closed_n_m_per_rad": 8.0 * opened,
        "stiffness_open_n_m_per_rad": opened,
        "damping_n_m_s_per_rad": loss_s(rng) * opened,
        "opening_rad": float(rng.uniform(0.0, 3e-6)),
    }
    return hidden("one_sided", link, table, stiffness_open_n_m_per_rad=opened)


def parallelogram_bar(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A bar beside the second link, from a crank to the third link's tail."""
    near, far = places.elastic[1:3]
    axis = np.array(places.joints[far]["axis"])
    tail = np.cross(axis, unit(rng))
    tail *= 0.1 / np.linalg.norm(tail)
    k = places.joints[far]["stiffness_n_m_per_rad"] * BAR * magnitude * about(rng) / 0.1**2
    table = {
        "kind": "parallelogram",
        "joint": near,
        "joint_after": far,
        "tail_m": plain(tail),
        "stiffness_n_per_m": float(k),
        "damping_n_s_per_m": float(loss_s(rng) * k),
        "mass_kg": float(rng.uniform(0.5, 1.5)),
    }
    place = [near, far]
    return hidden("parallelogram_bar", place, table, stiffness_n_per_m=float(k))
