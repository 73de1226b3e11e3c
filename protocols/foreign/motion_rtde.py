"""The table that Universal Robots' own RTDE client records, in the words of a log of motion.

Its columns are named as the controller's outputs, one number each: `timestamp`, s; `actual_q_0` to
`_5` and `target_q_0` to `_5`, rad, base outwards; `actual_tool_accelerometer_0` to `_2`, m/s^2.
They stand between spaces or commas. Source: RTDE guide and client library 2.7 of Universal Robots.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from armodal.protocols.arm.records import Arm

__all__ = ["TOOL_ACCELEROMETER", "is_rtde", "rtde_columns"]

TOOL_ACCELEROMETER = "actual_tool_accelerometer"
_DEG = 180.0 / math.pi


def is_rtde(names: Sequence[str]) -> bool:
    """Whether a table's columns are RTDE outputs with joint angles."""
    return "timestamp" in names and bool({"actual_q_0", "target_q_0"} & set(names))


def rtde_columns(
    names: Sequence[str], arm: Arm, roles: Mapping[str, str]
) -> tuple[list[str], list[float]]:
    """Return each column's name in a log of motion, and what its numbers are multiplied by.

    Parameters
    ----------
    roles
        The test point that the tool's accelerometer is at.
    """
    known = {"timestamp": ("time_s", 1.0)}
    for number, joint in enumerate(arm.joints):
        known[f"actual_q_{number}"] = (f"{joint.name}_encoder_deg", _DEG)
        known[f"target_q_{number}"] = (f"{joint.name}_command_deg", _DEG)
    for point, source in roles.items():
        if source == TOOL_ACCELEROMETER:
            for number, axis in enumerate("xyz"):
                known[f"{source}_{number}"] = (f"acc_{point}_{axis}_m_s2", 1.0)
    found = [known.get(name, (name, 1.0)) for name in names]
    return [name for name, _ in found], [scale for _, scale in found]
