"""Figures of a plain structure for print: poles over order, and shapes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal import ModalModel, stable_poles
from armodal.analyzer.modal.plscf import Stabilisation
from armodal.analyzer.report.arm_svg import fitted, polyline
from armodal.analyzer.report.palette import DRIVEN, FAINT, GRID, REST
from armodal.analyzer.report.plain_words import long_side, shape_of
from armodal.analyzer.report.shape_figures import LARGEST_MOTION, motion_of, places_of, tree_of
from armodal.analyzer.report.svg_plot import Curve, Panel, figure, number, panels_figure
from armodal.protocols.arm.records import Arm

__all__ = ["bar_tiles", "moving_tiles", "poles_svg"]

Array = npt.NDArray[np.float64]

_TILE = 150.0
# Right and up of a view along (-1, -1, -0.7), as the figure that moves begins with.
_VIEW = np.array([[-0.7071, -0.3113], [0.7071, -0.3113], [0.0, 0.8978]])


def poles_svg(model: ModalModel, tables: Sequence[Stabilisation]) -> str:
    """Poles over model orders, stable ones dark."""
    curves = []
    for stable, name, colour in ((False, "pole", FAINT), (True, "stable pole", DRIVEN)):
        kept = [stable_poles(table) == stable for table in tables]
        curves.append(
            Curve(
                x=np.concatenate([t.f_hz[k] for t, k in zip(tables, kept, strict=True)]),
                y=np.concatenate([t.order[k] for t, k in zip(tables, kept, strict=True)]).astype(
                    np.float64
                ),
                colour=colour,
                name=name,
                opacity=1.0 if stable else 0.5,
                dots=True,
            )
        )
    highest = max((float(t.order.max()) for t in tables if t.order.size), default=1.0)
    low, high = model.band_hz
    inside = [
        Curve(
            x=np.where((c.x >= low) & (c.x <= high), c.x, np.nan),
            y=c.y,
            colour=c.colour,
            name=c.name,
            opacity=c.opacity,
            dots=True,
        )
        for c in curves
    ]
    panel = Panel(curves=tuple(inside), height=262.0, label="model order", y_range=(0.0, highest))
    return panels_figure(
        [panel],
        (low, high),
        x_label="Hz",
        title="poles over model order",
        verticals=[mode.f_hz for mode in model.modes],
    )


def moving_tiles(arm: Arm, model: ModalModel) -> list[tuple[float, str]]:
    """Each mode on the points where they stand: (natural frequency in Hz, SVG)."""
    places = places_of(arm, model)
    index = {name: i for i, name in enumerate(places)}
    rest = np.array(list(places.values()))
    size = float(np.linalg.norm(np.ptp(rest, axis=0)))
    edges = tree_of(rest)
    tiles = []
    for mode in model.modes:
        motion = motion_of(model, shape_of(model, mode), index, size * LARGEST_MOTION).real
        (still, moved), height = fitted([rest @ _VIEW, (rest + motion) @ _VIEW], _TILE, _TILE, 10.0)
        parts = [polyline(still[[a, b]], REST, 2.0) for a, b in edges]
        parts += [polyline(moved[[a, b]], DRIVEN, 2.0) for a, b in edges]
        tiles.append(
            (mode.f_hz, figure("".join(parts), height, f"shape {mode.f_hz:.5g} Hz", _TILE))
        )
    return tiles


def bar_tiles(model: ModalModel) -> list[tuple[float, str]]:
    """Each mode's shape by point, on its best real line: (natural frequency in Hz, SVG)."""
    tiles = []
    for mode in model.modes:
        shape = mode.participation if long_side(model) else mode.shape
        turned = (shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))).real
        values = turned / np.max(np.abs(shape))
        wide = _TILE / len(values)
        parts = [f'<path d="M0 40H{_TILE:g}" stroke="{GRID}"/>']
        parts += [
            f'<rect x="{number(i * wide)}" y="{number(40.0 - max(36.0 * v, 0.0))}" '
            f'width="{max(wide - 1.0, 0.5):.2f}" height="{number(abs(36.0 * v))}" fill="{DRIVEN}"/>'
            for i, v in enumerate(values)
        ]
        tiles.append((mode.f_hz, figure("".join(parts), 80.0, f"shape {mode.f_hz:.5g} Hz", _TILE)))
    return tiles
