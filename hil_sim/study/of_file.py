"""Effects that an arm file holds, as effects of the simulated arm.

An arm file gives an effect's sizes with deviations, lines and points in link frames
(`docs/arm-file.md`). The simulated arm has the twins of `hil_sim.effects`, drawn from those
deviations. What a file does not tell of them is the laboratory's own: a rotor's gear ratio, a
base's radii, what a bearing loses, how a link's mass is cut where it bends.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.effects.bearing import across
from armodal.hil_sim.streams import stream
from armodal.hil_sim.study.laws_of_file import LAWS, Unlike, compensator
from armodal.hil_sim.study.model_error import INTERFACE_LOSS_S, Tables
from armodal.hil_sim.study.plant_of_arm import rotations
from armodal.protocols.arm.records import AddedEffect, Arm
from armodal.protocols.errors import PlantError

__all__ = ["OF_THE_TEST", "with_file_effects"]

Array = npt.NDArray[np.float64]

# Of a session, not of the arm: the laboratory has sensors and a hand of its own.
OF_THE_TEST = frozenset(
    {
        "channel_gain",
        "delay",
        "exponential_window",
        "flipped_axis",
        "hammer_gain",
        "hit_direction",
        "sensor_mass",
        "swapped_axes",
        "wrong_point",
    }
)
_BASE_RADII_2_M2 = (0.01, 0.01, 0.015)  # of gyration, squared: a plate of some 0.2 m


@dataclass(frozen=True, slots=True, kw_only=True)
class _Read:
    """An effect with its true sizes."""

    arm: Arm
    effect: AddedEffect
    sizes: dict[str, float]
    loss_s: float  # damping over stiffness of what the file tells none of

    def link(self, link: str) -> Array:
        """(3, 3) from a link's frame of the arm file to the plant's."""
        return rotations(self.arm)[link]

    def vector(self, key: str, of: str) -> Array:
        """(3,) from `key`_x, _y, _z, in the plant's frame of a link."""
        own = np.array([self.sizes.get(f"{key}_{axis}", 0.0) for axis in "xyz"])
        return np.asarray(self.link(of) @ own)


@dataclass(slots=True)
class _Made:
    """What becomes of a plant's tables."""

    effects: list[Tables] = field(default_factory=list)
    replaced: set[tuple[str, str]] = field(default_factory=set)  # ordinary errors, kind and joint
    damping: dict[str, float] = field(default_factory=dict)  # N m s/rad of joints


def with_file_effects(tables: Tables, arm: Arm, seed: int) -> Tables:
    """Return a plant's tables with the effects of an arm file in them.

    Raises
    ------
    PlantError
        If an effect has no twin, or lacks a size; all are named.
    """
    made, faults = _Made(), []
    for effect in arm.effects:
        if effect.name in OF_THE_TEST:
            continue
        twin = _TWINS.get(effect.name)
        if twin is None:
            faults.append(f"{effect.name} ({effect.place}), of which it has none")
            continue
        rng_of = partial(stream, seed, "file effect", effect.name, effect.place)
        low, high = np.log(INTERFACE_LOSS_S)
        own = _Read(
            arm=arm,
            effect=effect,
            sizes=_drawn(effect, rng_of),
            loss_s=float(np.exp(rng_of("loss").uniform(low, high))),
        )
        try:
            twin(own, made)
        except KeyError as missing:
            faults.append(f"{effect.name} ({effect.place}), which lacks {missing.args[0]}")
        except Unlike as what:
            faults.append(f"{effect.name} ({effect.place}): it has no {what}")
    if faults:
        raise PlantError(
            f"arm '{arm.name}': wanted effects that the simulated laboratory has too, got "
            f"{'; '.join(faults)}; give the arm file without them"
        )
    kept = [
        table
        for table in tables["effects"]
        if (table["kind"], table.get("joint", "")) not in made.replaced
    ]
    links = [
        link | {"damping_n_m_s_per_rad": made.damping[link["joint"]]}
        if link["joint"] in made.damping
        else link
        for link in tables["links"]
    ]
    return tables | {"links": links, "effects": [*kept, *made.effects]}


def _drawn(effect: AddedEffect, rng_of: Callable[[str], np.random.Generator]) -> dict[str, float]:
    """True sizes: what is positive by its logarithm, none beyond two deviations."""
    found = {}
    for own in effect.parameters:
        off = float(np.clip(rng_of(own.name).standard_normal(), -2.0, 2.0)) * own.std
        positive = own.value > 0.0
        found[own.name] = own.value * np.exp(off / own.value) if positive else own.value + off
    return found


def _spring(compliance: float, loss_s: float = 0.0) -> dict[str, float]:
    k = 1.0 / compliance
    return {"stiffness_n_m_per_rad": k, "damping_n_m_s_per_rad": loss_s * k}


def _link_axis(own: _Read, made: _Made) -> None:
    told = own.effect.description
    link = str(told["link"])
    before = str(told.get("points_before", "")).split()
    made.effects.append(
        {
            "kind": "link_axis",
            "link": link,
            "name": f"axis of the file in {link}",
            "direction": tuple(own.link(link) @ _three(told["direction"])),
            "point_m": tuple(own.link(link) @ _three(told["point_m"])),
            "mass_before": own.sizes.get("axis_mass_before", 0.0) if before else 0.0,
            "points_before": tuple(before),
        }
        | _spring(own.sizes["axis_compliance"], own.sizes.get("axis_loss", 0.0))
    )


def _bearing(own: _Read, made: _Made) -> None:
    """Two hinges through the joint; in place of the weak ones that every joint has."""
    joint = next(j for j in own.arm.joints if j.name == own.effect.place)
    told = own.effect.description
    if "direction_a" in told:
        sides = [_three(told[f"direction_{side}"]) for side in "ab"]
    else:
        sides = list(across(np.asarray(joint.axis)))
    made.replaced.add(("bearing", joint.name))
    for side, direction in zip("ab", sides, strict=True):
        compliance = own.sizes[f"bearing_{side}"]
        if compliance <= 0.0:
            continue
        made.effects.append(
            {
                "kind": "link_axis",
                "link": joint.link.name,
                "name": f"bearing {side} of the file at {joint.name}",
                "direction": tuple(own.link(joint.link.name) @ direction),
                "point_m": (0.0, 0.0, 0.0),
            }
            | _spring(compliance, own.loss_s)
        )


def _base(own: _Read, made: _Made) -> None:
    mass = max(own.sizes["mass"], 1e-3)
    xx, yy, zz = (mass * radius for radius in _BASE_RADII_2_M2)
    ways = [f"{kind}_{axis}" for kind in ("shift", "rock") for axis in "xyz"]
    made.replaced.add(("base", ""))
    made.effects.append(
        {
            "kind": "base",
            "pivot_m": (0.0, 0.0, own.sizes.get("pivot", 0.0)),
            "mass_kg": mass,
            "center_m": (0.0, 0.0, own.sizes.get("height", 0.0)),
            "inertia_kg_m2": (xx, 0.0, 0.0, yy, 0.0, zz),
            "springs": tuple(
                {
                    "way": way,
                    "stiffness": 1.0 / own.sizes[way],
                    "damping": own.loss_s / own.sizes[way],
                }
                for way in ways
                if own.sizes[way] > 0.0
            ),
        }
    )


def _payload(own: _Read, made: _Made) -> None:
    """Its moments are about the link's centre."""
    place, mass = own.effect.place, own.sizes["payload"]
    center = next(j.link.center_m for j in own.arm.joints if j.link.name == place)
    moment = own.vector("payload_moment", place)
    own_inertia = mass * own.sizes.get("payload_radius_of_gyration", 0.0) ** 2
    made.effects.append(
        {
            "kind": "payload",
            "link": place,
            "mass_kg": mass,
            "center_m": tuple(own.link(place) @ center + moment / mass),
            "inertia_kg_m2": (own_inertia, 0.0, 0.0, own_inertia, 0.0, own_inertia),
        }
    )


def _rotor(own: _Read, made: _Made) -> None:
    made.effects.append(
        {"kind": "rotor", "joint": own.effect.place, "inertia_kg_m2": own.sizes["rotor"]}
    )


def _servo(own: _Read, made: _Made) -> None:
    spring = _spring(own.sizes["servo_compliance"], own.sizes.get("servo_loss", 0.0))
    made.effects.append(
        {
            "kind": "rotor",
            "joint": own.effect.place,
            "inertia_kg_m2": own.sizes["servo_rotor"],
            "servo_stiffness_n_m_per_rad": spring["stiffness_n_m_per_rad"],
            "servo_damping_n_m_s_per_rad": spring["damping_n_m_s_per_rad"],
        }
    )


def _coupling(own: _Read, made: _Made) -> None:
    """Its sizes are parts of the geometric mean of both joints' springs and dampers in the file."""
    joints = _two_joints(own)
    k, c = (
        float(np.sqrt(np.prod([1.0 if e is None else e.value for e in pair])))
        for pair in zip(*((j.stiffness, j.damping) for j in joints), strict=True)
    )
    made.effects.append(
        {
            "kind": "coupling",
            "joints": tuple(joint.name for joint in joints),
            "cross_stiffness_n_m_per_rad": own.sizes["coupling"] * k,
            "cross_damping_n_m_s_per_rad": own.sizes.get("coupling_loss", 0.0) * c,
        }
    )


def _wrist_coupling(own: _Read, made: _Made) -> None:
    driver, driven = (joint.name for joint in _two_joints(own))
    _release(driven, own, made)
    made.effects.append(
        {
            "kind": "wrist_coupling",
            "driver": driver,
            "driven": driven,
            "ratio": own.sizes["wrist_ratio"],
        }
    )


def _released_joint(own: _Read, made: _Made) -> None:
    _release(own.effect.place, own, made)


def _release(joint: str, own: _Read, made: _Made) -> None:
    made.replaced.add(("released_joint", joint))
    made.effects.append(
        {"kind": "released_joint", "joint": joint} | _spring(own.sizes["compliance_of"], own.loss_s)
    )


def _encoder_offset(own: _Read, made: _Made) -> None:
    """In the file it is what the joint stands beyond its reading."""
    made.replaced.add(("encoder_offset", own.effect.place))
    made.effects.append(
        {
            "kind": "encoder_offset",
            "joint": own.effect.place,
            "offset_deg": -float(np.rad2deg(own.sizes["encoder"])),
        }
    )


def _hysteretic(own: _Read, made: _Made) -> None:
    made.replaced.add(("hysteretic", ""))
    for joint in own.arm.joints:
        loss = own.sizes.get(f"loss_{joint.name}", 0.0)
        if loss > 0.0:
            made.effects.append(
                {
                    "kind": "hysteretic",
                    "joints": (joint.name,),
                    "loss_factor": min(loss, 0.3),
                    "reference_hz": 30.0,  # at which the file's stiffness is meant
                }
            )
        ln_c = own.sizes.get(f"ln_c_{joint.name}")
        if ln_c is not None:
            made.damping[joint.name] = float(np.exp(ln_c))


def _sliced(kind: str, stiffness: str, own: _Read, made: _Made) -> None:
    """Along the line to the next joint."""
    names = [joint.link.name for joint in own.arm.joints]
    at = names.index(own.effect.place)
    if at + 1 == len(names):
        raise KeyError("a joint behind it")
    word = "bending" if kind == "bending" else "torsion"
    to = own.link(names[at]) @ np.asarray(own.arm.joints[at + 1].T_parent_joint[:3, 3])
    made.effects.append(
        {
            "kind": kind,
            "link": names[at],
            "from_m": (0.0, 0.0, 0.0),
            "to_m": tuple(to),
            "loss": own.sizes.get(f"{word}_loss", 0.0),
            stiffness: 1.0 / own.sizes[f"{word}_compliance"],
        }
    )


def _damper(own: _Read, made: _Made) -> None:
    start, _, end = own.effect.place.partition(" and ")
    made.effects.append(
        {
            "kind": "dashpot",
            "from_link": start,
            "from_m": tuple(own.vector("damper_from", "base" if start == "floor" else start)),
            "to_link": end,
            "to_m": tuple(own.vector("damper_to", end)),
            "damping_n_s_per_m": own.sizes["damper"],
        }
    )


def _load_damping(own: _Read, made: _Made) -> None:
    made.effects.append(
        {
            "kind": "load_damping",
            "joint": own.effect.place,
            "load_n_m": 1.0 / own.sizes["damping_per_load"],
        }
    )


def _law(law: Callable[..., Tables], own: _Read, made: _Made) -> None:
    joint = next(j for j in own.arm.joints if j.name == own.effect.place)
    made.effects.append(law(own.effect, own.sizes, joint))


def _compensator(own: _Read, made: _Made) -> None:
    joint = next(j for j in own.arm.joints if j.name == own.effect.place)
    axis = own.link(joint.link.name) @ np.asarray(joint.axis)
    made.effects.append(compensator(own.sizes, joint, axis))


def _two_joints(own: _Read) -> tuple[Any, Any]:
    joints = own.arm.joints
    pairs = ((a, b) for a in joints for b in joints)
    return next((a, b) for a, b in pairs if f"{a.name} and {b.name}" == own.effect.place)


def _three(values: object) -> Array:
    if not isinstance(values, Sequence):
        raise KeyError("three numbers")
    return np.array([float(value) for value in values])


_TWINS: dict[str, Callable[[_Read, _Made], None]] = {
    **{name: partial(_law, law) for name, law in LAWS.items()},
    "gravity_compensator": _compensator,
    "base": _base,
    "bearing": _bearing,
    "coupling": _coupling,
    "encoder_offset": _encoder_offset,
    "hysteretic": _hysteretic,
    "link_axis": _link_axis,
    "link_bending": partial(_sliced, "bending", "bending_stiffness_n_m2"),
    "link_torsion": partial(_sliced, "torsion", "torsional_stiffness_n_m2"),
    "load_damping": _load_damping,
    "nonproportional": _damper,
    "payload": _payload,
    "released_joint": _released_joint,
    "rotor": _rotor,
    "servo": _servo,
    "wrist_coupling": _wrist_coupling,
}
