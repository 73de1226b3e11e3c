"""Losses and amplitude-dependent stiffness, hidden at their clear size times a magnitude."""

from __future__ import annotations

import numpy as np

from armodal.hil_sim.effects.hidden import Hidden, about, hidden, plain
from armodal.hil_sim.study.places import ArmPlaces

__all__ = [
    "backlash",
    "friction",
    "hysteretic",
    "load_damping",
    "microslip",
    "nonproportional",
    "softening",
]

HYSTERETIC_LOSS = 0.2
DASHPOT = 2.0  # about the joints between its ends, of their mean damping
LOAD_DAMPING = 2.0  # more damping at the largest load of the postures
# Amplitude-dependent: as parts of the joint's swing after a hit of middle level.
FRICTION = 0.14  # limit / (stiffness x swing)
MICROSLIP = 0.45
SEAT = 2.0  # stiffness of the friction's seat / the joint's
MICROSLIP_SEAT = 0.4
SOFT_PART, SOFT_AT = 0.4, 0.5
PLAY = 0.2  # half of it / swing

Rng = np.random.Generator


def hysteretic(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Losses of the joints' drives that do not grow with frequency."""
    loss = float(HYSTERETIC_LOSS * magnitude * about(rng))
    table = {
        "kind": "hysteretic",
        "joints": tuple(places.elastic),
        "loss_factor": loss,
    }
    return hidden("hysteretic", places.elastic, table, loss_factor=loss)


def nonproportional(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A damper from the floor or the first link to a link beyond the second joint."""
    names = list(places.links)
    near = "floor" if rng.random() < 0.5 else names[0]
    far = names[int(rng.integers(2, 4))]
    first = places.reach(names[1])
    lever = 0.6 * float(np.linalg.norm(first))
    joints = [places.joints[name]["damping_n_m_s_per_rad"] for name in places.elastic[:3]]
    damping = float(DASHPOT * magnitude * about(rng) * np.mean(joints) / lever**2)
    from_m = (0.25, 0.3, 0.1) if near == "floor" else plain(places.somewhere(rng, near))
    to_m = plain(places.somewhere(rng, far))
    table = {
        "kind": "dashpot",
        "from_link": near,
        "from_m": from_m,
        "to_link": far,
        "to_m": to_m,
        "damping_n_s_per_m": damping,
    }
    return hidden(
        "nonproportional",
        [near, far],
        table,
        damping_n_s_per_m=damping,
        from_m=list(from_m) if near == "floor" else places.in_file(near, from_m),
        to_m=places.in_file(far, to_m),
    )


def load_damping(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Losses that grow with the weight a joint carries."""
    loads = {joint: places.loads(joint) for joint in places.elastic[1:3] or places.elastic}
    joint = str(rng.choice(list(loads)))
    largest = max(abs(load) for load in loads[joint])
    load = largest / (LOAD_DAMPING * magnitude * about(rng))
    table = {"kind": "load_damping", "joint": joint, "load_n_m": load}
    return hidden("load_damping", joint, table, load_n_m=load)


def friction(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Coulomb friction: it sticks while the swing is small."""
    return _friction("friction", FRICTION, SEAT, 1, places, rng, magnitude)


def microslip(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A seat that slips little by little."""
    return _friction("microslip", MICROSLIP, MICROSLIP_SEAT, 6, places, rng, magnitude)


def softening(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A joint softer for larger motion."""
    joint = places.main_joint(rng)
    part, at = SOFT_PART * magnitude * about(rng), SOFT_AT * places.swing(joint)
    table = {"kind": "softening", "joint": joint, "part": part, "at_rad": at}
    return hidden("softening", joint, table, part=part, at_rad=at)


def backlash(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Play where weight does not close it in most postures: in the joint with the least load."""
    loads = {name: float(np.median(np.abs(places.loads(name)))) for name in places.elastic[:4]}
    joint = min(loads, key=lambda name: loads[name])
    half = PLAY * places.swing(joint) * magnitude * about(rng)
    table = {"kind": "backlash", "joint": joint, "half_rad": half}
    return hidden("backlash", joint, table, half_rad=half)


def _friction(
    name: str,
    size: float,
    seat: float,
    elements: int,
    places: ArmPlaces,
    rng: Rng,
    magnitude: float,
) -> Hidden:
    joint = places.main_joint(rng)
    k = places.joints[joint]["stiffness_n_m_per_rad"]
    limit = size * k * places.swing(joint) * magnitude * about(rng)
    table = {
        "kind": "friction",
        "joint": joint,
        "limit_n_m": limit,
        "stiffness_n_m_per_rad": seat * k,
        "elements": elements,
    }
    return hidden(name, joint, table, limit_n_m=limit, stiffness_n_m_per_rad=seat * k)
