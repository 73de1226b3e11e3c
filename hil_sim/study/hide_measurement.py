"""Faults of the measurement, hidden at their clear size times a magnitude."""

from __future__ import annotations

import numpy as np

from armodal.hil_sim.effects.hidden import Hidden, about, hidden, plain, unit
from armodal.hil_sim.study.places import ArmPlaces

__all__ = [
    "channel_gain",
    "delay",
    "encoder_offset",
    "exponential_window",
    "flipped_axis",
    "hammer_gain",
    "hit_direction",
    "swapped_axes",
    "wrong_point",
]

CHANNEL_GAIN = 0.25
HAMMER_GAIN = 0.45
DELAY_S = 6e-4
ENCODER_DEG = 4.0
HIT_DEG = 12.0
WINDOW = 3.0  # minus the logarithm of its end
MOVED_M = 0.12

Rng = np.random.Generator


def flipped_axis(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """One axis: at all points when clear, at one when not."""
    axis, points = str(rng.choice(list("xyz"))), _points(places, rng, magnitude)
    table = {"kind": "flipped_axis", "axis": axis, "points": points}
    return hidden("flipped_axis", list(points) or "all", table, axis=axis)


def swapped_axes(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Two axes: at all points when clear, at one when not."""
    left_out = int(rng.integers(3))
    axes, points = tuple("xyz".replace("xyz"[left_out], "")), _points(places, rng, magnitude)
    table = {"kind": "swapped_axes", "axes": axes, "points": points}
    return hidden("swapped_axes", list(points) or "all", table, axes=list(axes))


def channel_gain(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """One channel, at all points or at one."""
    axis, points = str(rng.choice(list("xyz"))), _points(places, rng, float(rng.random() * 2.0))
    factor = _factor(CHANNEL_GAIN, rng, magnitude)
    table = {"kind": "channel_gain", "axis": axis, "factor": factor, "points": points}
    return hidden("channel_gain", list(points) or "all", table, axis=axis, factor=factor)


def hammer_gain(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """The hammer's sensitivity."""
    del places
    factor = _factor(HAMMER_GAIN, rng, magnitude)
    return hidden("hammer_gain", "hammer", {"kind": "hammer_gain", "factor": factor}, factor=factor)


def delay(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Hammer or all of the accelerometer, late."""
    del places
    late_s = float(DELAY_S * magnitude * about(rng))
    of_hammer = rng.random() < 0.5
    table = {
        "kind": "delay",
        "channels": ("hammer",) if of_hammer else ("acc_x", "acc_y", "acc_z"),
        "delay_s": late_s,
    }
    return hidden("delay", "hammer" if of_hammer else "accelerometer", table, delay_s=late_s)


def encoder_offset(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """One of the joints whose angle matters."""
    joint = str(rng.choice(list(places.joints)[1:5] or list(places.joints)))
    offset = float(rng.choice([-1.0, 1.0]) * ENCODER_DEG * magnitude * about(rng))
    table = {"kind": "encoder_offset", "joint": joint, "offset_deg": offset}
    return hidden("encoder_offset", joint, table, offset_deg=offset)


def wrong_point(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """Two points of a link exchanged when clear; else one point off its place."""
    links = [name for name in places.structural() if name != list(places.links)[-1]]
    link = str(rng.choice(links))
    points = [point["id"] for point in places.points[link]]
    if magnitude >= 1.0:
        pair = sorted(str(name) for name in rng.choice(points, 2, replace=False))
        table = {"kind": "exchanged_points", "points": tuple(pair)}
        return hidden("wrong_point", pair, table, exchanged=pair)
    point = str(rng.choice(points))
    by = MOVED_M * magnitude * about(rng) * unit(rng)
    moved = {"kind": "moved_point", "point": point, "by_m": plain(by)}
    return hidden("wrong_point", [point], moved, by_m=places.in_file(link, by))


def hit_direction(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """All hits turned alike, about an axis across the first posture's."""
    wanted = places.study.plan.postures[0].hit_direction
    across = np.cross(np.array([0.0, 0.0, 1.0]) if wanted is None else wanted, unit(rng))
    degrees = HIT_DEG * magnitude * about(rng)
    turn = degrees * across / np.linalg.norm(across)
    table = {"kind": "hit_direction", "turn_deg": plain(turn)}
    return hidden("hit_direction", "hammer", table, turn_deg=list(plain(turn)))


def exponential_window(places: ArmPlaces, rng: Rng, magnitude: float) -> Hidden:
    """A front end's window that nobody corrects."""
    del places
    end = float(np.exp(-WINDOW * magnitude * about(rng)))
    table = {"kind": "exponential_window", "end": end}
    return hidden("exponential_window", "all", table, end=end)


def _points(places: ArmPlaces, rng: Rng, magnitude: float) -> tuple[str, ...]:
    """All points when clear; else one on a moving link."""
    if magnitude >= 1.0:
        return ()
    moving = [p["id"] for name in places.structural() for p in places.points[name]]
    return (str(rng.choice(moving)),)


def _factor(step: float, rng: Rng, magnitude: float) -> float:
    """Too large or too small."""
    return float(np.exp(rng.choice([-1.0, 1.0]) * step * magnitude * about(rng)))
