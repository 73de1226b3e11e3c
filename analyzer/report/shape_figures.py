"""Mode shapes of a plain structure: moving on the geometry, or as bars by point."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go
import scipy

from armodal.analyzer.modal import ModalModel
from armodal.analyzer.report.page_text import shown
from armodal.analyzer.report.plain_words import long_side, shape_of
from armodal.protocols.arm.records import Arm
from armodal.protocols.foreign.session_texts import UNKNOWN_PLACES

__all__ = [
    "LARGEST_MOTION",
    "has_geometry",
    "motion_of",
    "moving_shapes_figure",
    "places_of",
    "shape_bars_figure",
    "tree_of",
]

LARGEST_MOTION = 0.15  # of the structure's size
PHASES, CYCLES = 16, 6
EYE = {"x": 2.2, "y": 2.2, "z": 1.5}  # far enough to see all corners on a narrow screen
REST, MOVING = "#9aa5b1", "#1f5fa8"


def _dofs(model: ModalModel) -> Any:
    return model.references if long_side(model) else model.responses


def places_of(arm: Arm, model: ModalModel) -> dict[str, npt.NDArray[np.float64]]:
    """Measured points whose place is known: position (3,) in m by name."""
    unknown = set(arm.groups.get(UNKNOWN_PLACES, ()))
    measured = {dof.point for dof in _dofs(model)}
    return {
        point.id: point.position_m
        for point in arm.points
        if point.id in measured and point.id not in unknown
    }


def has_geometry(arm: Arm, model: ModalModel) -> bool:
    """Whether two measured points or more stand at known places apart."""
    places = np.array(list(places_of(arm, model).values())).reshape(-1, 3)
    return len(places) > 1 and bool(np.ptp(places, axis=0).max() > 0.0)


def moving_shapes_figure(arm: Arm, model: ModalModel) -> Any:
    """Points at rest and, for a mode chosen by its frequency, in motion.

    Lines join nearest points (the shortest tree): files seldom tell what is joined.
    """
    places = places_of(arm, model)
    index = {name: i for i, name in enumerate(places)}
    rest = np.array(list(places.values()))
    size = float(np.linalg.norm(np.ptp(rest, axis=0)))
    path = np.array([[a, b, -1] for a, b in tree_of(rest)]).reshape(-1)
    largest_m = LARGEST_MOTION * size
    motions = [motion_of(model, shape_of(model, mode), index, largest_m) for mode in model.modes]
    figure = go.Figure()
    figure.add_scatter3d(
        **_lines(rest, path), mode="lines", line={"width": 3, "color": REST}, name="at rest"
    )
    figure.add_scatter3d(
        **_xyz(rest),
        mode="markers+text",
        text=[shown(name) for name in places],
        marker={"size": 3, "color": REST},
        showlegend=False,
    )
    figure.add_scatter3d(
        **_lines(rest + motions[0].real, path),
        mode="lines+markers",
        line={"width": 6, "color": MOVING},
        marker={"size": 4, "color": MOVING},
        name="in motion",
    )
    figure.frames = [
        go.Frame(
            name=f"{number}/{phase}",
            data=[
                go.Scatter3d(
                    **_lines(rest + (motion * np.exp(2j * np.pi * phase / PHASES)).real, path)
                )
            ],
            traces=[2],
        )
        for number, motion in enumerate(motions)
        for phase in range(PHASES)
    ]
    play = {
        "frame": {"duration": 60, "redraw": True},
        "transition": {"duration": 0},
        "mode": "immediate",
    }
    buttons = [
        {
            "label": f"{number + 1}: {mode.f_hz:.5g} Hz",
            "method": "animate",
            "args": [[f"{number}/{phase}" for phase in range(PHASES)] * CYCLES, play],
        }
        for number, mode in enumerate(model.modes)
    ]
    # A beam has no width: what moves still needs room.
    spans = [
        np.concatenate([[rest.min(0) - abs(m).max(0)], [rest.max(0) + abs(m).max(0)]])
        for m in motions
    ]
    low, high = np.min([s[0] for s in spans], axis=0), np.max([s[1] for s in spans], axis=0)
    middle, half = 0.5 * (low + high), np.maximum(0.5 * (high - low), 0.1 * size)
    axes = {
        f"{axis}axis": {"range": [middle[i] - half[i], middle[i] + half[i]], "title": f"{axis}, m"}
        for i, axis in enumerate("xyz")
    }
    return figure.update_layout(
        height=520,
        scene={"aspectmode": "data", "camera": {"eye": EYE}, **axes},
        modebar={"orientation": "v"},
        updatemenus=[{"buttons": buttons, "x": 0.0, "xanchor": "left", "y": 1.0}],
        legend={"orientation": "h", "x": 1.0, "xanchor": "right", "y": 1.0, "yanchor": "bottom"},
        margin={"l": 5, "r": 5, "t": 40, "b": 5},
    )


def shape_bars_figure(model: ModalModel) -> Any:
    """Each mode's shape by degree of freedom, on its best real line, with standard deviations."""
    dofs, roving_hammer = _dofs(model), long_side(model)
    names = [shown(f"{dof.point} {dof.label}") for dof in dofs]
    if len(set(names)) < len(names):
        names = [f"{name} ({i + 1})" for i, name in enumerate(names)]
    figure = go.Figure()
    for number, mode in enumerate(model.modes):
        shape = mode.participation if roving_hammer else mode.shape
        std = mode.participation_std if roving_hammer else mode.shape_std
        scale = float(np.max(np.abs(shape)))
        turn = np.exp(-0.5j * np.angle(np.sum(shape**2)))
        figure.add_bar(
            x=names,
            y=(shape * turn).real / scale,
            error_y={"type": "data", "array": std.real / scale},
            marker={"color": MOVING},
            name="real part",
            visible=number == 0,
        )
    buttons = [
        {
            "label": f"{number + 1}: {mode.f_hz:.5g} Hz",
            "method": "update",
            "args": [{"visible": [k == number for k in range(len(model.modes))]}],
        }
        for number, mode in enumerate(model.modes)
    ]
    figure.update_yaxes(title="shape, largest 1", range=[-1.15, 1.15], zeroline=True)
    figure.update_xaxes(title="point and direction", type="category")
    return figure.update_layout(
        height=360,
        showlegend=False,
        modebar={"orientation": "v"},
        updatemenus=[
            {"buttons": buttons, "x": 0.0, "xanchor": "left", "y": 1.02, "yanchor": "bottom"}
        ],
        margin={"l": 60, "r": 15, "t": 60, "b": 45},
    )


def tree_of(rest: npt.NDArray[np.float64]) -> list[tuple[int, int]]:
    """Pairs of points that a shortest tree joins."""
    apart = scipy.spatial.distance.cdist(rest, rest)
    tree = scipy.sparse.csgraph.minimum_spanning_tree(apart).tocoo()
    return [(int(a), int(b)) for a, b in zip(tree.row, tree.col, strict=True)]


def motion_of(
    model: ModalModel, shape: npt.NDArray[np.complex128], index: dict[str, int], largest_m: float
) -> npt.NDArray[np.complex128]:
    """Complex motion (n_points, 3), its largest real part drawn so long."""
    shape = shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))
    moved = np.zeros((len(index), 3), dtype=np.complex128)
    for value, dof in zip(shape, _dofs(model), strict=True):
        if dof.point in index:
            moved[index[dof.point]] += value * dof.direction
    largest = float(np.linalg.norm(moved.real, axis=1).max())
    return moved * largest_m / max(largest, 1e-30)


def _lines(points: npt.NDArray[np.float64], path: npt.NDArray[np.int64]) -> dict[str, Any]:
    """Points along a path; -1 lifts the pen."""
    drawn = np.where((path < 0)[:, None], np.nan, points[path])
    return _xyz(drawn)


def _xyz(points: npt.NDArray[np.float64]) -> dict[str, Any]:
    return {"x": points[:, 0], "y": points[:, 1], "z": points[:, 2]}
