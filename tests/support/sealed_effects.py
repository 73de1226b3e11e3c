"""Effects to hide in a plant: each kind at its clear size times a magnitude, drawn from a seed.

A kind gives the tables of the plant file and a record of the truth in the field's words. Places
and directions in records are in the arm file's link frames.
"""

import numpy as np

# Sizes at magnitude 1.
RELEASED_COMPLIANCE = 1.2e-4  # rad / N m
BEARING_COMPLIANCE = 4e-6  # both ways across
AXIS_COMPLIANCE = 6e-6
ROCKING_COMPLIANCE = 4e-6
SHIFT_COMPLIANCE = 4e-8  # m / N
LOSS_S = 4e-5  # damping / stiffness of compliances
COUPLING = 0.4  # of the geometric mean of both stiffnesses
PAYLOAD_KG = 2.0
ROTOR = 0.4  # of the link's inertia about the joint, at least 0.3 kg m2
SERVO = 0.4  # servo compliance / joint compliance
HYSTERETIC_LOSS = 0.12
CHANNEL_GAIN = 0.25
HAMMER_GAIN = 0.16
DELAY_S = 6e-4
ENCODER_DEG = 4.0
PACK_KG = 2.5
CRACK_COMPLIANCE = 3e-5
BENDING_COMPLIANCE = 3e-5  # of the whole link, rad / N m


class ArmPlaces:
    """Where effects can sit on an arm."""

    def __init__(self, arm, tables):
        self.arm = arm
        self.links = {link["name"]: link for link in tables["links"]}
        self.joints = {link["joint"]: link for link in tables["links"]}
        self.elastic = [
            name
            for name, link in self.joints.items()
            if link["stiffness_n_m_per_rad"] is not None
        ]
        self.rigid = [name for name in self.joints if name not in self.elastic]
        self.points = {}
        for point in tables["points"]:
            self.points.setdefault(point["link"], []).append(point)
        self.rotation, R = {}, np.eye(3)
        for joint in arm.joints:
            R = R @ joint.T_parent_joint[:3, :3]
            self.rotation[joint.link.name] = R

    def structural(self):
        """Links with two points at least: what bends in them can be seen."""
        return [name for name in self.links if len(self.points.get(name, ())) > 1]

    def in_file(self, link, vector):
        """A vector of the plant's link frame in the arm file's."""
        return (self.rotation[link].T @ np.asarray(vector)).tolist()


def released_joint(places, rng, magnitude):
    """A joint the arm file calls rigid."""
    joint = places.rigid[0] if len(places.rigid) > 1 else places.rigid[-1]
    k = 1.0 / (RELEASED_COMPLIANCE * magnitude * _about(rng))
    c = 0.06 * k / (2.0 * np.pi * 100.0)
    table = {
        "kind": "released_joint",
        "joint": joint,
        "stiffness_n_m_per_rad": k,
        "damping_n_m_s_per_rad": c,
    }
    return [table], _truth("released_joint", joint, stiffness_n_m_per_rad=k)


def bearing(places, rng, magnitude):
    """A joint's bearing, alike both ways across."""
    joint = str(rng.choice(places.elastic[:3]))
    k = 1.0 / (BEARING_COMPLIANCE * magnitude * _about(rng))
    table = {
        "kind": "bearing",
        "joint": joint,
        "stiffness_n_m_per_rad": (k, k),
        "damping_n_m_s_per_rad": (LOSS_S * k, LOSS_S * k),
    }
    return [table], _truth("bearing", joint, compliance_rad_per_n_m=1.0 / k)


def link_axis(places, rng, magnitude):
    """An axis in any direction, sometimes with a part of the link before it."""
    link = str(rng.choice(places.structural()))
    point, direction = _somewhere(places, rng, link), _unit(rng)
    k = 1.0 / (AXIS_COMPLIANCE * magnitude * _about(rng))
    table = {
        "kind": "link_axis",
        "link": link,
        "point_m": tuple(point.tolist()),
        "direction": tuple(direction.tolist()),
        "stiffness_n_m_per_rad": k,
        "damping_n_m_s_per_rad": LOSS_S * k,
    }
    if rng.random() < 0.3 and len(places.points[link]) > 2:
        near = min(places.points[link], key=lambda p: float(np.linalg.norm(p["position_m"])))
        table |= {"mass_before": 0.25, "points_before": (near["id"],)}
    return [table], _truth(
        "link_axis",
        link,
        compliance_rad_per_n_m=1.0 / k,
        point_m=places.in_file(link, point),
        direction=places.in_file(link, direction),
    )


def base(places, rng, magnitude):
    """The base rocks, and shifts in half of the cases."""
    rock = 1.0 / (ROCKING_COMPLIANCE * magnitude * np.array([_about(rng), _about(rng)]))
    springs = [
        {"way": f"rock_{axis}", "stiffness": float(k), "damping": float(LOSS_S * k)}
        for axis, k in zip("xy", rock, strict=True)
    ]
    parameters = {f"rock_{a}_n_m_per_rad": float(k) for a, k in zip("xy", rock, strict=True)}
    if rng.random() < 0.5:
        shift = 1.0 / (SHIFT_COMPLIANCE * magnitude * np.array([_about(rng), _about(rng)]))
        springs += [
            {"way": f"shift_{axis}", "stiffness": float(k), "damping": float(LOSS_S * k)}
            for axis, k in zip("xy", shift, strict=True)
        ]
        parameters |= {f"shift_{a}_n_per_m": float(k) for a, k in zip("xy", shift, strict=True)}
    mass = float(rng.uniform(8.0, 25.0))
    table = {
        "kind": "base",
        "pivot_m": (0.0, 0.0, float(rng.uniform(-0.05, 0.02))),
        "mass_kg": mass,
        "center_m": (0.0, 0.0, 0.08),
        "inertia_kg_m2": (0.015 * mass, 0.0, 0.0, 0.015 * mass, 0.0, 0.02 * mass),
        "springs": tuple(springs),
    }
    return [table], _truth("base", "base", base_mass_kg=mass, **parameters)


def coupling(places, rng, magnitude):
    """Two neighbouring joints, the wrist's where they give way."""
    pairs = list(zip(places.elastic[1:-1], places.elastic[2:], strict=True))
    pair = pairs[int(rng.integers(len(pairs)))]
    ends = [places.joints[name] for name in pair]
    part = float(rng.choice([-1.0, 1.0]) * COUPLING * magnitude * _about(rng))
    k = part * np.sqrt(np.prod([end["stiffness_n_m_per_rad"] for end in ends]))
    c = part * np.sqrt(np.prod([end["damping_n_m_s_per_rad"] for end in ends]))
    table = {
        "kind": "coupling",
        "joints": pair,
        "cross_stiffness_n_m_per_rad": float(k),
        "cross_damping_n_m_s_per_rad": float(c),
    }
    return [table], _truth("coupling", list(pair), cross_stiffness_n_m_per_rad=float(k))


def payload(places, rng, magnitude):
    """On the last link or on the one that carries the wrist."""
    names = list(places.links)
    link = names[-1] if rng.random() < 0.6 else names[3]
    mass = PAYLOAD_KG * magnitude * _about(rng)
    center = np.array(places.links[link]["center_m"]) + 0.06 * _unit(rng)
    own = 0.002 * mass
    table = {
        "kind": "payload",
        "link": link,
        "mass_kg": float(mass),
        "center_m": tuple(center.tolist()),
        "inertia_kg_m2": (own, 0.0, 0.0, own, 0.0, own),
    }
    return [table], _truth(
        "payload", link, mass_kg=float(mass), center_m=places.in_file(link, center)
    )


def rotor(places, rng, magnitude):
    """Reflected inertia that turns as the joint does."""
    joint, inertia = _rotor_of(places, rng, magnitude)
    table = {"kind": "rotor", "joint": joint, "inertia_kg_m2": inertia}
    return [table], _truth("rotor", joint, inertia_kg_m2=inertia)


def servo(places, rng, magnitude):
    """A soft servo, the rotor a degree of freedom of its own."""
    joint, inertia = _rotor_of(places, rng, 1.0)
    own = places.joints[joint]
    k = own["stiffness_n_m_per_rad"] / (SERVO * magnitude * _about(rng))
    table = {
        "kind": "rotor",
        "joint": joint,
        "inertia_kg_m2": inertia,
        "servo_stiffness_n_m_per_rad": float(k),
        "servo_damping_n_m_s_per_rad": float(2.0 * own["damping_n_m_s_per_rad"]),
    }
    return [table], _truth(
        "servo", joint, inertia_kg_m2=inertia, servo_stiffness_n_m_per_rad=float(k)
    )


def hysteretic(places, rng, magnitude):
    """Losses of the joints' drives that do not grow with frequency."""
    loss = float(HYSTERETIC_LOSS * magnitude * _about(rng))
    table = {
        "kind": "hysteretic",
        "joints": tuple(places.elastic),
        "loss_factor": loss,
        "replaces_viscous": magnitude > 0.7,
    }
    return [table], _truth("hysteretic", places.elastic, loss_factor=loss)


def flipped_axis(places, rng, magnitude):
    """One axis: at all points when clear, at one when not."""
    axis, points = str(rng.choice(list("xyz"))), _points(places, rng, magnitude)
    table = {"kind": "flipped_axis", "axis": axis, "points": points}
    return [table], _truth("flipped_axis", list(points) or "all", axis=axis)


def swapped_axes(places, rng, magnitude):
    """Two axes: at all points when clear, at one when not."""
    left_out = int(rng.integers(3))
    axes, points = tuple("xyz".replace("xyz"[left_out], "")), _points(places, rng, magnitude)
    table = {"kind": "swapped_axes", "axes": axes, "points": points}
    return [table], _truth("swapped_axes", list(points) or "all", axes=list(axes))


def channel_gain(places, rng, magnitude):
    """One channel, at all points or at one."""
    axis, points = str(rng.choice(list("xyz"))), _points(places, rng, float(rng.random() * 2.0))
    step = CHANNEL_GAIN * magnitude * _about(rng)
    factor = float(np.exp(rng.choice([-1.0, 1.0]) * step))
    table = {"kind": "channel_gain", "axis": axis, "factor": factor, "points": points}
    return [table], _truth("channel_gain", list(points) or "all", axis=axis, factor=factor)


def hammer_gain(places, rng, magnitude):
    """The hammer's sensitivity."""
    del places
    step = HAMMER_GAIN * magnitude * _about(rng)
    factor = float(np.exp(rng.choice([-1.0, 1.0]) * step))
    return [{"kind": "hammer_gain", "factor": factor}], _truth(
        "hammer_gain", "hammer", factor=factor
    )


def delay(places, rng, magnitude):
    """Hammer or all of the accelerometer, late."""
    del places
    late_s = float(DELAY_S * magnitude * _about(rng))
    late = ("hammer",) if rng.random() < 0.5 else ("acc_x", "acc_y", "acc_z")
    place = "hammer" if late == ("hammer",) else "accelerometer"
    return [{"kind": "delay", "channels": late, "delay_s": late_s}], _truth(
        "delay", place, delay_s=late_s
    )


def encoder_offset(places, rng, magnitude):
    """One of the joints whose angle matters."""
    joint = str(rng.choice(list(places.joints)[1:5]))
    offset = float(rng.choice([-1.0, 1.0]) * ENCODER_DEG * magnitude * _about(rng))
    return [{"kind": "encoder_offset", "joint": joint, "offset_deg": offset}], _truth(
        "encoder_offset", joint, offset_deg=offset
    )


def dress_pack(places, rng, magnitude):
    """A hanging bundle; in no library."""
    link = list(places.links)[2 if rng.random() < 0.5 else 3]
    mass = float(PACK_KG * magnitude * _about(rng))
    hertz = float(rng.uniform(9.0, 40.0))
    table = {
        "kind": "dress_pack",
        "link": link,
        "position_m": tuple(_somewhere(places, rng, link).tolist()),
        "mass_kg": mass,
        "frequency_hz": hertz,
        "damping_ratio": float(rng.uniform(0.04, 0.15)),
    }
    return [table], _truth("dress_pack", link, mass_kg=mass, frequency_hz=hertz)


def one_sided(places, rng, magnitude):
    """A crack that opens a little above rest; in no library."""
    link = str(rng.choice(places.structural()[:4]))
    opened = 1.0 / (CRACK_COMPLIANCE * magnitude * _about(rng))
    table = {
        "kind": "one_sided",
        "link": link,
        "point_m": tuple(_somewhere(places, rng, link).tolist()),
        "direction": tuple(_unit(rng).tolist()),
        "stiffness_closed_n_m_per_rad": 8.0 * opened,
        "stiffness_open_n_m_per_rad": opened,
        "damping_n_m_s_per_rad": LOSS_S * opened,
        "opening_rad": float(rng.uniform(0.0, 3e-6)),
    }
    return [table], _truth("one_sided", link, stiffness_open_n_m_per_rad=opened)


def bending(places, rng, magnitude):
    """A link that bends all along; in no library."""
    link = list(places.links)[1 if rng.random() < 0.5 else 3]
    reach = 2.0 * np.array(places.links[link]["center_m"])
    whole = BENDING_COMPLIANCE * magnitude * _about(rng)
    stiffness = float(np.linalg.norm(reach) / whole)
    table = {
        "kind": "bending",
        "link": link,
        "from_m": (0.0, 0.0, 0.0),
        "to_m": tuple(reach.tolist()),
        "bending_stiffness_n_m2": stiffness,
        "loss": LOSS_S,
    }
    return [table], _truth("bending", link, bending_stiffness_n_m2=stiffness)


LIBRARY = {
    kind.__name__: kind
    for kind in (
        released_joint,
        bearing,
        link_axis,
        base,
        coupling,
        payload,
        rotor,
        servo,
        hysteretic,
        flipped_axis,
        swapped_axes,
        channel_gain,
        hammer_gain,
        delay,
        encoder_offset,
    )
}
OUTSIDE = {kind.__name__: kind for kind in (dress_pack, one_sided, bending)}


def _truth(name, place, **parameters):
    return {"name": name, "place": place, "parameters": parameters}


def _about(rng):
    """A size within a sixth of the nominal one."""
    return float(np.exp(rng.uniform(-0.15, 0.15)))


def _unit(rng):
    v = rng.standard_normal(3)
    return v / np.linalg.norm(v)


def _somewhere(places, rng, link):
    """A place in a link, between its joint and its centre."""
    return np.array(places.links[link]["center_m"]) * rng.uniform(0.2, 1.0) + 0.02 * _unit(rng)


def _points(places, rng, magnitude):
    """All points when clear; else one on a moving link."""
    if magnitude >= 1.0:
        return ()
    moving = [p["id"] for name in places.structural() for p in places.points[name]]
    return (str(rng.choice(moving)),)


def _rotor_of(places, rng, magnitude):
    joint = str(rng.choice(places.elastic[:3]))
    link = places.joints[joint]
    largest = max(link["inertia_kg_m2"][i] for i in (0, 3, 5))
    return joint, float(max(ROTOR * largest, 0.3) * magnitude * _about(rng))
