"""Point: what to mount where, how the sensor's axes must lie, where and along what to hit."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from rich.text import Text

from armodal.daq.geometry import hit_direction, link_rotation
from armodal.protocols.plan_records import Mode
from armodal.tui.screens.run.state import RunState
from armodal.tui.screens.run.views.hit import verdict_text
from armodal.tui.screens.run.views.parts import DIM, GOOD, WARN, big

__all__ = ["last_verdict_text", "point_text"]

NEARLY = 0.94  # of an axis: within 20 degrees it is named alone
SOME = 0.26  # 15 degrees
_WAYS = (("base +x", "base -x"), ("base +y", "base -y"), ("up", "down"))


def axis_words(direction: npt.NDArray[np.float64]) -> str:
    """Say in words where a unit vector (3,) of the base frame points.

    >>> axis_words(np.array([0.0, 0.0, -1.0]))
    'down'
    >>> axis_words(np.array([0.8, 0.0, 0.6]))
    'base +x and up'
    """
    order = np.argsort(-np.abs(direction))
    words = [_WAYS[i][0] if direction[i] > 0 else _WAYS[i][1] for i in order]
    if abs(direction[order[0]]) >= NEARLY:
        return words[0]
    named = [word for word, i in zip(words, order, strict=True) if abs(direction[i]) > SOME]
    return " and ".join(named[:2])


def point_text(state: RunState, width: int) -> Text:
    """Return what to do at the point in hand."""
    prompt = state.prompt
    if prompt is None or prompt.posture is None:
        return Text("")
    roving_hammer = state.plan.mode is Mode.ROVING_HAMMER
    posture = prompt.posture
    wanted = prompt.hit_point if roving_hammer else prompt.sensor_point
    text = big(f"POINT {wanted}", "bold", width=width)
    link = state.arm.point(wanted).link
    text.append(f"\non {link}, posture {posture.name}\n", style=DIM)
    if roving_hammer:
        text.append(f"Sensor stays at point {prompt.sensor_point}.\n")
        text.append(f"Hit point {prompt.hit_point} next.\n", style="bold")
    else:
        text.append(f"Mount the sensor at point {wanted}:\n", style="bold")
        placed = state.arm.point(wanted)
        axes = link_rotation(state.arm, placed.link, posture.joints_rad) @ placed.R_link_sensor
        for name, axis in zip("xyz", axes.T, strict=True):
            away = " (away from the surface)" if name == "z" else ""
            text.append(f"  {name}  {axis_words(axis)}{away}\n")
    direction = hit_direction(state.arm, posture, prompt.hit_point)
    text.append(f"Hammer: point {prompt.hit_point}, strike {axis_words(direction)}\n")
    if state.hand_doing:
        return text.append(f"the simulated hand {state.hand_doing} ...", style=WARN)
    if state.hand_did == f"mounts the sensor at {prompt.sensor_point}":
        text.append("✓ the simulated hand has mounted it\n", style=GOOD)
    elif state.simulated:
        text.append("h: the simulated hand mounts it\n", style=DIM)
    text.append("Enter: mounted, ready to hit", style=GOOD)
    return text


def last_verdict_text(state: RunState, width: int) -> Text:
    """Return the verdict on the hit before, which has finished its point; empty before any."""
    if state.last_hit is None and state.last_taken_back is None:
        return Text("")
    return Text().append("last hit\n", style=DIM).append_text(verdict_text(state, width, 4))
