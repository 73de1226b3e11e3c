"""Every effect that a case can hide, by the name that a verdict should give it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from armodal.hil_sim.study import (
    hide_damping,
    hide_drive,
    hide_measurement,
    hide_outside,
    hide_structure,
)
from armodal.hil_sim.study.places import ArmPlaces, Hidden

__all__ = [
    "FIRST",
    "LIBRARY",
    "MAGNITUDES",
    "MORE",
    "OUTSIDE",
    "PLACED",
    "SIZED",
    "Maker",
]

Maker = Callable[[ArmPlaces, np.random.Generator, float], Hidden]

MAGNITUDES = {"clear": 1.0, "medium": 0.5, "faint": 0.25}

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
}

OUTSIDE: dict[str, Maker] = {
    "dress_pack": hide_outside.dress_pack,
    "one_sided": hide_outside.one_sided,
    "parallelogram_bar": hide_outside.parallelogram_bar,
}

FIRST = tuple(LIBRARY)[:15]
"""The first library of the gap workflow."""

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
