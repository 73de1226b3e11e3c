"""Drives and transmissions, hidden at their clear size times a magnitude."""

from __future__ import annotations

import numpy as np

from hil_sim.study.places import ArmPlaces, Hidden, about, hidden, plain, unit

__all__ = ["coupling", "payload", "rotor", "servo"]

COUPLING = 0.4  # of the geometric mean of both stiffnesses
ROTOR = 0.15  # of the inertia that the joint carries in the first posture
SERVO = 0.4  # servo compliance / joint compliance
PAYLOAD = 0.035  # of the arm's mass

Rng = np.random.Generator


def coupling(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Two neighbouring joints, the wrist's where they give way."""
    pairs = list(zip(places.elastic[1:-1], places.elastic[2:], strict=True))
    pair = pairs[int(rng.integers(len(pairs)))]
    ends = [places.joints[name] for name in pair]
    part = float(rng.choice([-1.0, 1.0]) * COUPLING * magnitude * about(rng))
    k = part * np.sqrt(np.prod([end["stiffness_n_m_per_rad"] for end in ends]))
    c = part * np.sqrt(np.prod([end["damping_n_m_s_per_rad"] for end in ends]))
    table = {
        "kind": "coupling",
        "joints": pair,
        "cross_stiffness_n_m_per_rad": float(k),
        "cross_damping_n_m_s_per_rad": float(c),
    }
    return hidden("coupling", list(pair), table, cross_stiffness_n_m_per_rad=float(k))


def payload(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """On the last link or on the one that carries the wrist."""
    names = list(places.links)
    link = names[-1] if rng.random() < 0.6 else names[3]
    arm_kg = sum(link["mass_kg"] for link in places.links.values())
    mass = float(PAYLOAD * arm_kg * magnitude * about(rng))
    center = np.array(places.links[link]["center_m"]) + 0.06 * unit(rng)
    own = 0.002 * mass
    table = {
        "kind": "payload",
        "link": link,
        "mass_kg": mass,
        "center_m": plain(center),
        "inertia_kg_m2": (own, 0.0, 0.0, own, 0.0, own),
    }
    return hidden("payload", link, table, mass_kg=mass, center_m=places.in_file(link, center))


def rotor(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Reflected inertia that turns as the joint does."""
    joint = places.main_joint(rng)
    inertia = ROTOR * places.carried(joint) * magnitude * about(rng)
    table = {"kind": "rotor", "joint": joint, "inertia_kg_m2": inertia}
    return hidden("rotor", joint, table, inertia_kg_m2=inertia)


def servo(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A soft servo, the rotor a degree of freedom of its own."""
    joint = places.main_joint(rng)
    inertia = ROTOR * places.carried(joint) * about(rng)
    own = places.joints[joint]
    k = own["stiffness_n_m_per_rad"] / (SERVO * magnitude * about(rng))
    table = {
        "kind": "rotor",
        "joint": joint,
        "inertia_kg_m2": inertia,
        "servo_stiffness_n_m_per_rad": float(k),
        "servo_damping_n_m_s_per_rad": float(2.0 * own["damping_n_m_s_per_rad"]),
    }
    return hidden(
        "servo", joint, table, inertia_kg_m2=inertia, servo_stiffness_n_m_per_rad=float(k)
    )
