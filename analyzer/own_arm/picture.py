"""A page that shows an arm's bodies with its points, their ids, normals and sensor x axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go
from markupsafe import escape

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.report.policy import under_policy
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.arm.records import Arm

__all__ = ["points_page"]

Array = npt.NDArray[np.float64]

_BODY, _POINT, _NORMAL, _X = "#9aa5b1", "#b3261e", "#1f5fa8", "#2e7d32"
_LONG = 0.04  # of the arm's size: a drawn normal
_MOST_TRIANGLES = 4000  # of a body: a page of some megabytes; its hull is drawn above


def points_page(arm: Arm, bodies: Sequence[ArmBody], joints_rad: Array) -> str:
    """One self-contained HTML page of the arm in a posture.

    Parameters
    ----------
    bodies
        The arm's, base first.
    joints_rad
        (n_joints,).
    """
    poses = [np.eye(4), *(link_pose(arm, joint.link.name, joints_rad) for joint in arm.joints)]
    figure = go.Figure()
    for body, T in zip(bodies, poses, strict=True):
        vertices, triangles = _drawn(body)
        x, y, z = (vertices @ T[:3, :3].T + T[:3, 3]).T
        i, j, k = triangles.T
        figure.add_mesh3d(
            x=x, y=y, z=z, i=i, j=j, k=k, color=_BODY, opacity=0.55, flatshading=True,
            name=str(escape(body.name)), hoverinfo="name",
        )  # fmt: skip
    names = {body.name: number for number, body in enumerate(bodies)} | {"base": 0}
    size = float(np.ptp([T[:3, 3] for T in poses], axis=0).max())
    places, normals, along = [], [], []
    for point in arm.points:
        T = poses[names[point.link]]
        axes = T[:3, :3] @ point.R_link_sensor
        places.append(T[:3, :3] @ point.position_m + T[:3, 3])
        normals.append(axes[:, 2])
        along.append(axes[:, 0])
    at = np.array(places)
    x, y, z = at.T
    figure.add_scatter3d(
        x=x, y=y, z=z, mode="markers+text", text=[str(escape(point.id)) for point in arm.points],
        marker={"size": 4, "color": _POINT}, name="points",
    )  # fmt: skip
    for vectors, colour, name in ((normals, _NORMAL, "sensor z"), (along, _X, "sensor x")):
        x, y, z = _arrows(at, _LONG * size * np.array(vectors)).T
        figure.add_scatter3d(
            x=x, y=y, z=z, mode="lines", line={"width": 5, "color": colour}, name=name
        )
    figure.update_layout(
        scene={
            "aspectmode": "data",
            "xaxis_title": "x m",
            "yaxis_title": "y m",
            "zaxis_title": "z m",
        },
        margin={"l": 0, "r": 0, "t": 0, "b": 0},
        height=800,
        legend={"y": 0.9},  # below the plot's buttons
    )
    told = ", ".join(f"{angle:.0f}" for angle in np.rad2deg(joints_rad))
    title = f"Points of {escape(arm.name)}"
    plot: Any = figure.to_html(full_html=False, include_plotlyjs=True)
    page = (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{title}</title></head>'
        f'<body style="font-family: sans-serif"><h1>{title}</h1><p>Joints at {told} degrees. Turn '
        "it with the mouse. Blue stands out of the surface, as the sensor's z does; green is its x."
        f"</p>{plot}</body></html>"
    )
    return under_policy(page)


def _drawn(body: ArmBody) -> tuple[Array, npt.NDArray[np.int64]]:
    surface = body.seen
    if len(surface.triangles) <= _MOST_TRIANGLES:
        return surface.vertices_m, surface.triangles
    shells = [
        (shell.vertices_m, shell.triangles)
        if len(shell.triangles) <= _MOST_TRIANGLES
        else (shell.vertices_m, shell.hull.simplices.astype(np.int64))
        for shell in body.shells
    ]
    offsets = np.cumsum([0, *(len(vertices) for vertices, _ in shells)])[:-1]
    return (
        np.concatenate([vertices for vertices, _ in shells]),
        np.concatenate([faces + off for (_, faces), off in zip(shells, offsets, strict=True)]),
    )


def _arrows(at: Array, along: Array) -> Array:
    """Lines from places along vectors, with a gap after each, (3 n, 3)."""
    gap = np.full_like(at, np.nan)
    return np.stack([at, at + along, gap], axis=1).reshape(-1, 3)
