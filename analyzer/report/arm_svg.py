"""The arm drawn for print: at rest with what was found on it, and moving in a mode."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import PostureDynamics, Superset
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.analyzer.modal import ModalModel
from armodal.analyzer.report.palette import DRIVEN, FOUND, INK, REST
from armodal.analyzer.report.svg_plot import LETTER, figure, number, text
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["MarkedAxis", "fitted", "found_svg", "polyline", "shape_tiles"]

Array = npt.NDArray[np.float64]

ELEVATION_RAD = 0.35  # the view from above
AZIMUTHS = 36  # tried, to see the arm as wide as can be
AXIS_SHARE = 0.3  # half length of an axis, of the arm's size
SHAPE_SHARE = 0.12  # the largest motion of a mode, of the arm's size
_TILE = 150.0


@dataclass(frozen=True, slots=True, kw_only=True)
class MarkedAxis:
    """An axis to draw, in its link's frame."""

    link: str
    direction_link: Array  # (3,)
    point_link_m: Array  # (3,)
    label: str


def found_svg(
    superset: Superset, joints_rad: Array, axes: tuple[MarkedAxis, ...], places: tuple[str, ...]
) -> str:
    """The arm in a posture with axes drawn, and with joints or links marked by their name.

    Parameters
    ----------
    places
        Names of joints and links where something was found that has no axis.
    """
    posture = superset.posture(joints_rad)
    chain = _chain(posture)
    size = float(np.linalg.norm(np.ptp(chain, axis=0)))
    names = [joint.link.name for joint in superset.arm.joints]
    lines = []
    for axis in axes:
        T = posture.T_base_link[names.index(axis.link)]
        middle = T[:3, :3] @ axis.point_link_m + T[:3, 3]
        half = T[:3, :3] @ axis.direction_link * AXIS_SHARE * size
        lines.append((np.array([middle - half, middle + half]), axis.label))
    points = posture.point_position
    view = _view([chain, *(line for line, _ in lines)])
    drawn, height = fitted(
        [chain @ view, points @ view, *(line @ view for line, _ in lines)], 440.0, 330.0
    )
    marked = {
        i
        for i, joint in enumerate(superset.arm.joints)
        if {joint.name, joint.link.name} & set(places)
    }
    parts = [polyline(drawn[0], REST, 11.0)]
    parts += [polyline(drawn[0][i + 1 : i + 3], FOUND, 11.0) for i in marked]
    parts += [
        f'<circle cx="{number(x)}" cy="{number(y)}" r="2.2" fill="{INK}" opacity=".55"/>'
        for x, y in drawn[1]
    ]
    for i, (x, y) in enumerate(drawn[0][1:]):
        colour = FOUND if i in marked else "#fff"
        parts.append(
            f'<circle cx="{number(x)}" cy="{number(y)}" r="6" fill="{colour}" stroke="{INK}"/>'
        )
    parts += _joint_names([joint.name for joint in superset.arm.joints], drawn[0][1:])
    for line, (_, label) in zip(drawn[2:], lines, strict=True):
        parts.append(polyline(line, FOUND, 3.5, dash="9 4"))
        height += LETTER + 4.0
        parts.append(polyline(np.array([[0.0, height - 8.0], [26.0, height - 8.0]]), FOUND, 3.5))
        parts.append(text(34.0, height - 4.0, label, more=_bold(FOUND)))
    return figure("".join(parts), height, "the arm and what was found on it")


def shape_tiles(
    superset: Superset, frf: FrequencyResponse, model: ModalModel
) -> list[tuple[float, str]]:
    """Each mode's shape as a small drawing: (natural frequency in Hz, SVG)."""
    if frf.joints_rad is None:
        return []
    posture = superset.posture(frf.joints_rad)
    chain = _chain(posture)
    size = float(np.linalg.norm(np.ptp(chain, axis=0)))
    measured = MeasuredModes.of(superset, posture, model)
    used = np.unique(measured.index)
    used = used[np.argsort(np.array(superset.point_link)[used], kind="stable")]
    tiles = []
    for mode, shape in zip(model.modes, measured.shapes.T, strict=True):
        motion = np.zeros(posture.point_position.shape)
        turned = shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))
        np.add.at(motion, measured.index, turned.real[:, None] * measured.directions)
        largest = float(np.linalg.norm(motion, axis=1).max())
        rest = posture.point_position[used]
        moved = rest + motion[used] * SHAPE_SHARE * size / max(largest, 1e-30)
        # Each mode is seen from where it moves most.
        view = _view([chain, moved], motion[used])
        drawn, height = fitted([chain @ view, rest @ view, moved @ view], _TILE, _TILE, 10.0)
        parts = [polyline(drawn[0], REST, 5.0)]
        parts += [
            polyline(np.array([start, end]), DRIVEN, 2.0)
            for start, end in zip(drawn[1], drawn[2], strict=True)
        ]
        parts += [
            f'<circle cx="{number(x)}" cy="{number(y)}" r="2.4" fill="{DRIVEN}"/>'
            for x, y in drawn[2]
        ]
        tiles.append(
            (mode.f_hz, figure("".join(parts), height, f"shape at {mode.f_hz:.2f} Hz", _TILE))
        )
    return tiles


def _chain(posture: PostureDynamics) -> Array:
    """Base, joints from the base outwards: (n_joints + 1, 3)."""
    return np.vstack([np.zeros(3), posture.T_base_link[:, :3, 3]])


def _view(shown: list[Array], motion: Array | None = None) -> Array:
    """Columns right and up of the view that shows what is shown widest, or a motion largest.

    Returns
    -------
    (3, 2) float64
    """
    stacked = np.vstack(shown)
    best, most = np.zeros((3, 2)), -1.0
    for azimuth in np.arange(AZIMUTHS) * np.pi / AZIMUTHS:
        right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        ahead = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        up = np.sin(ELEVATION_RAD) * ahead + np.array([0.0, 0.0, np.cos(ELEVATION_RAD)])
        view = np.stack([right, up], axis=1)
        seen = float(np.ptp(stacked @ right))
        if motion is not None:
            seen = float(np.linalg.norm(motion @ view))
        if seen > most:
            best, most = view, seen
    return best


def fitted(
    groups: list[Array], width: float, height: float, margin: float = 34.0
) -> tuple[list[Array], float]:
    """Projected points moved and scaled into a picture of that width and at most that height."""
    stacked = np.vstack(groups)
    low, span = stacked.min(axis=0), np.maximum(np.ptp(stacked, axis=0), 1e-9)
    scale = float(np.min((np.array([width, height]) - 2.0 * margin) / span))
    tall = span[1] * scale + 2.0 * margin
    left = 0.5 * (width - span[0] * scale)
    return [
        np.stack(
            [
                left + (group[:, 0] - low[0]) * scale,
                tall - margin - (group[:, 1] - low[1]) * scale,
            ],
            axis=1,
        )
        for group in groups
    ], float(tall)


def _joint_names(names: list[str], places: Array) -> list[str]:
    """Names beside the joints; joints at one place share a line."""
    parts: list[str] = []
    left = list(range(len(names)))
    while left:
        first = left[0]
        here = [i for i in left if np.linalg.norm(places[i] - places[first]) < 16.0]
        left = [i for i in left if i not in here]
        said = ", ".join(names[i] for i in here)
        x, y = places[first]
        end = x > 280.0
        parts.append(
            text(x + (-10.0 if end else 10.0), y + 16.0, said, anchor="end" if end else "start")
        )
    return parts


def polyline(points: Array, colour: str, width: float, *, dash: str = "") -> str:
    """A line through projected points (n, 2)."""
    at = "L".join(f"{number(x)} {number(y)}" for x, y in points)
    return (
        f'<path d="M{at}" stroke="{colour}" stroke-width="{width:g}" fill="none" '
        f'stroke-linecap="round" stroke-linejoin="round" stroke-dasharray="{dash}"/>'
    )


def _bold(colour: str) -> str:
    return f'fill="{colour}" font-weight="600"'
