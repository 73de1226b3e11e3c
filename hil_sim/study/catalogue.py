"""Every effect that a case can hide, by the name that a verdict should give it.

A module of `hil_sim.effects` that makes cases of itself is found by its name. It offers

    hide(places, rng, magnitude)    what is hidden, at its clear size times a magnitude
    SINCE                           the version of the library it came with
    SIZED                           whether its clear size is found case by case
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from armodal.hil_sim.effects import modules_with
from armodal.hil_sim.effects.hidden import Hidden
from armodal.hil_sim.study import (
    hide_damping,
    hide_drive,
    hide_measurement,
    hide_outside,
    hide_structure,
)
from armodal.hil_sim.study.places import ArmPlaces
from armodal.protocols.errors import PlantError

__all__ = [
    "LIBRARY",
    "MAGNITUDES",
    "MORE",
    "OUTSIDE",
    "PLACED",
    "SIZED",
    "VERSION",
    "Maker",
    "library",
]

Maker = Callable[[ArmPlaces, np.random.Generator, float], Hidden]

MAGNITUDES = {"clear": 1.0, "medium": 0.5, "faint": 0.25}

_FOUND = modules_with("hide")

LIBRARY: dict[str, Maker] = {
    "released_joint": hide_structure.released_joint,
    "bearing": hide_structure.bearing,
    "link_axis": hide_structure.link_axis,
    "base": hide_structure.base,
    "coupling": hide_drive.coupling,
    "payload": hide_drive.payload,
    "rotor": hide_drive.rotor,
    "servo": hide_drive.servo,
    "hysteretic": hide_damping.hysteretic,
    "flipped_axis": hide_measurement.flipped_axis,
    "swapped_axes": hide_measurement.swapped_axes,
    "channel_gain": hide_measurement.channel_gain,
    "hammer_gain": hide_measurement.hammer_gain,
    "delay": hide_measurement.delay,
    "encoder_offset": hide_measurement.encoder_offset,
    "link_bending": hide_structure.link_bending,
    "link_torsion": hide_structure.link_torsion,
    "wrist_coupling": hide_drive.wrist_coupling,
    "gravity_compensator": hide_drive.gravity_compensator,
    "sensor_mass": hide_drive.sensor_mass,
    "nonproportional": hide_damping.nonproportional,
    "load_damping": hide_damping.load_damping,
    "friction": hide_damping.friction,
    "microslip": hide_damping.microslip,
    "softening": hide_damping.softening,
    "backlash": hide_damping.backlash,
    "wrong_point": hide_measurement.wrong_point,
    "hit_direction": hide_measurement.hit_direction,
    "exponential_window": hide_measurement.exponential_window,
    **{name: module.hide for name, module in _FOUND.items()},
}

OUTSIDE: dict[str, Maker] = {
    "dress_pack": hide_outside.dress_pack,
    "one_sided": hide_outside.one_sided,
    "parallelogram_bar": hide_outside.parallelogram_bar,
}

_FIRST = 15  # effects of the first version; all others without a file of their own are the second's
_SINCE = {name: 1 if at < _FIRST else 2 for at, name in enumerate(LIBRARY)}
_SINCE |= {name: int(module.SINCE) for name, module in _FOUND.items()}

VERSION = max(_SINCE.values())
"""The newest version of the library."""


def library(version: int) -> tuple[str, ...]:
    """Return the effects of a version: a study of it is drawn alike whatever came later.

    Raises
    ------
    PlantError
        If there is no such version.
    """
    if not 1 <= version <= VERSION:
        raise PlantError(f"library {version}: wanted a version from 1 to {VERSION}; give one")
    return tuple(name for name in LIBRARY if _SINCE[name] <= version)


SIZED = frozenset(
    {
        "released_joint",
        "link_axis",
        "coupling",
        "payload",
        "rotor",
        "servo",
        "encoder_offset",
        "link_torsion",
        "wrist_coupling",
        "gravity_compensator",
        "nonproportional",
        "load_damping",
        "dress_pack",
        "parallelogram_bar",
        *(name for name, module in _FOUND.items() if module.SIZED),
    }
)
"""Effects whose clear size is found case by case; the others' is that of their maker.

Base, bearings and bending move weak modes too far for the search, which follows its first
sensitivities.
"""

PLACED = frozenset({"flipped_axis", "swapped_axes", "channel_gain"})
"""Faults of one point or of all: drawn where the channel moves enough to tell."""

MORE = {("bench57", "payload"): 10.0, ("ur5", "payload"): 2.5, ("bench57", "rotor"): 4.0}
"""By arm and effect: times the size that the search finds.

What tolerances of masses hide is more than the search's refit takes off: by these factors the
held-out error of an analysis without the effect is about three times that of one with it.
"""
