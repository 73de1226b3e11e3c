"""Steps: what the controller says is plausible."""

from __future__ import annotations

import math

import numpy as np

from armodal.daq.check.can_bench import CanRecording
from armodal.daq.check.verdict import Finding, failed, passed, unchecked
from armodal.protocols.can_database import load_database

__all__ = ["check_drive_state", "check_resolution", "check_scale", "check_still"]

COARSEST_BIT_DEG = 0.01
# Between the readings of a held arm: far above encoder noise, far below a posture's tolerance.
MOST_MOTION_DEG = 0.05
RANGE_SLACK_DEG = 1.0  # a zero that is off by less is the test's business, not the bus's


def check_scale(heard: CanRecording) -> Finding:
    """Step `scale`: every angle decodes and lies within the joint's range."""
    problems = [
        f"{len(message.refused)} frames of {message.name} cannot be used: {message.refused[0]}"
        for message in heard.messages
        if message.refused
    ]
    told = []
    for joint in heard.arm.joints:
        angles = np.degrees(heard.angles_rad(joint.name))
        if not len(angles):
            problems.append(f"{joint.name}: no angle came")
            continue
        low, high = (math.degrees(limit) for limit in joint.range_rad)
        if angles.min() < low - RANGE_SLACK_DEG or angles.max() > high + RANGE_SLACK_DEG:
            problems.append(
                f"{joint.name} is reported at {angles.min():.2f} to {angles.max():.2f} degrees, "
                f"its range is {low:g} to {high:g}"
            )
        told.append(f"{np.median(angles):.2f}")
    if problems:
        return failed(problems)
    return passed(f"joints at {', '.join(told)} degrees")


def check_resolution(heard: CanRecording) -> Finding:
    """Step `resolution`: the database's least bit of every joint is fine enough."""
    database = load_database(heard.mapping.database_text, heard.mapping.database)
    bits_deg = {}
    for joint in heard.mapping.joints:
        signal = database.get_message_by_name(joint.message).get_signal_by_name(joint.signal)
        bits_deg[joint.joint] = math.degrees(abs(joint.scale_rad * float(signal.scale)))
    coarse = {name: bit for name, bit in bits_deg.items() if bit > COARSEST_BIT_DEG}
    if coarse:
        return failed(f"{name}: a bit is {bit:.4g} degree" for name, bit in coarse.items())
    return passed(f"a bit is at most {max(bits_deg.values()):.2g} degree")


def check_drive_state(heard: CanRecording) -> Finding:
    """Step `drive-state`: the state is one that the database names."""
    wanted = heard.mapping.drive_state
    if wanted is None:
        return unchecked("the arm file names no drive state: a moving arm cannot be told")
    database = load_database(heard.mapping.database_text, heard.mapping.database)
    signal = database.get_message_by_name(wanted.message).get_signal_by_name(wanted.signal)
    names = {int(value): str(name) for value, name in (signal.choices or {}).items()}
    names |= {value: names.get(value, "held") for value in wanted.held_values}
    states = {
        int(update.signals[wanted.signal])
        for message in heard.messages
        for update in message.updates
        if wanted.signal in update.signals
    }
    if not states:
        return failed("no drive state came")
    unknown = sorted(states - names.keys())
    if unknown:
        known = ", ".join(f"{value} {name}" for value, name in sorted(names.items()))
        return failed(f"state {', '.join(map(str, unknown))} is not one of {known}")
    said = ", ".join(f"{value} {names[value]}" for value in sorted(states))
    if states <= set(wanted.held_values):
        return passed(f"{said}: held")
    return unchecked(f"state {said}: switch the drives on, so that they hold the arm, and repeat")


def check_still(heard: CanRecording) -> Finding:
    """Step `still`: while the drives hold the arm, its angles stand."""
    held = [u.held for m in heard.messages for u in m.updates if u.held is not None]
    if heard.mapping.drive_state is not None and not (held and held[-1]):
        return unchecked("the drives do not hold the arm")
    moved = {}
    for joint in heard.arm.joints:
        angles = heard.angles_rad(joint.name)
        if len(angles) > 1:
            moved[joint.name] = math.degrees(float(np.ptp(angles)))
    if not moved:
        return unchecked("fewer than two angles came")
    problems = [
        f"{name} moves by {span:.3f} degree"
        for name, span in moved.items()
        if span > MOST_MOTION_DEG
    ]
    return failed(problems) if problems else passed(f"at most {max(moved.values()):.4f} degree")
