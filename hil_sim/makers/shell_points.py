"""Where sensors sit: points on the shells of an arm's links."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from armodal.hil_sim.makers.arm_table import ArmTable, Array, Shell

__all__ = ["N_POINTS", "ShellPoint", "along", "shell_points"]

N_POINTS = 18
GOLDEN_ANGLE_RAD = np.pi * (3.0 - np.sqrt(5.0))  # no two points of an arm lie in one line


@dataclass(frozen=True, slots=True, kw_only=True)
class ShellPoint:
    """A point of the arm file; the columns of `R_link_sensor` are the sensor's axes."""

    id: str
    link: str  # or "base"
    position_m: Array  # (3,) link frame
    R_link_sensor: Array  # (3, 3)


@lru_cache(maxsize=8)
def shell_points(table: ArmTable) -> tuple[ShellPoint, ...]:
    """Place two points on every body, and the rest on those with the longest shells."""
    shells = [("base", table.base_shell)] + [(row.link, row.shell) for row in table.links]
    counts = dict.fromkeys((name for name, _ in shells), 2)
    longest = sorted(shells, key=lambda shell: -_length(shell[1]))
    for name, _ in longest[: N_POINTS - 2 * len(shells)]:
        counts[name] += 1
    points: list[ShellPoint] = []
    for name, shell in reversed(shells):  # from the flange inwards
        for i in range(counts[name]):
            center, tangent = along(shell, (i + 0.75) / (counts[name] + 0.5))
            points.append(_on_shell(len(points), name, center, tangent, 0.5 * shell.diameter_m))
    return tuple(points)


def along(shell: Shell, fraction: float) -> tuple[Array, Array]:
    """Point of a shell's line and unit tangent there, each (3,)."""
    path = np.array(shell.path)
    steps = np.diff(path, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    left = fraction * float(np.sum(lengths))
    for start, step, length in zip(path[:-1], steps, lengths, strict=True):
        if left <= length:
            return start + step * (left / length), step / length
        left -= length
    return path[-1], steps[-1] / lengths[-1]


def _length(shell: Shell) -> float:
    return float(np.sum(np.linalg.norm(np.diff(np.array(shell.path), axis=0), axis=1)))


def _on_shell(number: int, link: str, center: Array, tangent: Array, radius_m: float) -> ShellPoint:
    aside = np.eye(3)[int(np.argmin(np.abs(tangent)))]
    first = np.cross(tangent, aside)
    first /= np.linalg.norm(first)
    second = np.cross(tangent, first)
    angle = number * GOLDEN_ANGLE_RAD
    normal = np.cos(angle) * first + np.sin(angle) * second
    return ShellPoint(
        id=str(number + 1),
        link=link,
        position_m=center + radius_m * normal,
        R_link_sensor=np.column_stack([tangent, np.cross(normal, tangent), normal]),
    )
