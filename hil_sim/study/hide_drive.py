"""Drives and transmissions, hidden at their clear size times a magnitude."""

from __future__ import annotations

import numpy as np

from armodal.hil_sim.effects.hidden import Hidden, about, hidden, plain, unit
from armodal.hil_sim.study.places import ArmPlaces
from armodal.protocols.errors import PlantError

__all__ = [
    "coupling",
    "gravity_compensator",
    "payload",
    "rotor",
    "sensor_mass",
    "servo",
    "wrist_coupling",
]

COUPLING = 0.4  # of the geometric mean of both stiffnesses
ROTOR = 0.15  # of the inertia that the joint carries in the first posture
SERVO = 0.4  # servo compliance / joint compliance
PAYLOAD = 0.035  # of the arm's mass
COMPENSATOR = 0.35  # of the joint's stiffness, where the cylinder is square to its lever
WRIST_RATIO = 1.0
STIFF_WRIST_HZ = 600.0  # of the driven link on its spring
SENSOR_KG = 0.12

Rng = np.random.Generator


def coupling(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Two neighbouring joints, the wrist's where they give way."""
    pairs = list(zip(places.elastic, places.elastic[1:], strict=False))
    pairs = pairs[1:] or pairs  # the first joint turns all the others alike
    if not pairs:
        raise PlantError("coupling: wanted two joints with a stiffness, got fewer")
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
    link = names[-1] if rng.random() < 0.6 else names[min(3, len(names) - 1)]
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


def wrist_coupling(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """The last drive runs through the wrist: it turns back when the joint before it gives way.

    Its own spring is stiff, since the arm file calls it rigid.
    """
    if not places.rigid:
        raise PlantError("wrist_coupling: wanted a joint believed rigid, got none")
    driver, driven = places.elastic[-1], places.rigid[0]
    stiff = places.carried(driven) * (2.0 * np.pi * STIFF_WRIST_HZ) ** 2
    ratio = float(rng.choice([-1.0, 1.0]) * WRIST_RATIO * magnitude * about(rng))
    released = {
        "kind": "released_joint",
        "joint": driven,
        "stiffness_n_m_per_rad": stiff,
        "damping_n_m_s_per_rad": 1e-5 * stiff,
    }
    table = {"kind": "wrist_coupling", "driver": driver, "driven": driven, "ratio": ratio}
    return Hidden(
        tables=[released, table],
        name="wrist_coupling",
        place=[driver, driven],
        parameters={"ratio": ratio},
    )


def gravity_compensator(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A gas cylinder beside the joint that lifts, as stiff as when its valve is shut."""
    joint = places.elastic[min(1, len(places.elastic) - 1)]
    link = places.joints[joint]
    k = link["stiffness_n_m_per_rad"]
    axis = np.array(link["axis"])
    reach = places.reach(link["name"])
    along = reach - axis * (axis @ reach)
    along /= np.linalg.norm(along)
    lever = 0.35 * float(np.linalg.norm(reach))
    square = np.cross(axis, along) * float(rng.choice([-1.0, 1.0]))
    stiffness = float(COMPENSATOR * k * magnitude * about(rng) / lever**2)
    anchor, eye = lever * 1.4 * (square - 0.3 * along), lever * along
    table = {
        "kind": "gravity_compensator",
        "joint": joint,
        "anchor_m": plain(anchor),
        "eye_m": plain(eye),
        "tension_n": float(rng.uniform(500.0, 1500.0)),
        "stiffness_n_per_m": stiffness,
        "damping_n_s_per_m": 1e-4 * stiffness,
    }
    return hidden(
        "gravity_compensator",
        joint,
        table,
        stiffness_n_per_m=stiffness,
        anchor_m=places.in_file(places.before(link["name"]), anchor),
        eye_m=places.in_file(link["name"], eye),
    )


def sensor_mass(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Base and cable of the accelerometer, beside the mass that its file gives."""
    del places
    extra = float(SENSOR_KG * magnitude * about(rng))
    table = {"kind": "sensor_mass", "extra_kg": extra}
    return hidden("sensor_mass", "accelerometer", table, extra_kg=extra)
