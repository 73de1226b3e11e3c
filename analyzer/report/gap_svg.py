"""Figures of a gap result for print: errors before and after, and where they sit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from armodal.analyzer.gap.records import Disagreement, GapResult
from armodal.analyzer.report.page_text import shown
from armodal.analyzer.report.palette import DRIVEN, GRID, INK, MODEL
from armodal.analyzer.report.svg_plot import WIDTH, figure, number, text

__all__ = ["disagreement_svgs", "errors_svg"]

_ROW = 24.0
_LEFT, _RIGHT = 110.0, 12.0
_SHADES = ("#eef3f8", "#c9dcee", "#8fb8dc", "#4a8cc4", "#0b5cad", "#062f5c")
# Ratios up to 1 are what scatter explains; every shade above stands for twice as much as the last.
_FIRST_SHADE = 1.0


def errors_svg(result: GapResult) -> str:
    """FRF error of each posture before and after, beside what noise alone would leave."""
    before = result.gap_before
    if not before:
        return ""
    after = {row.posture: row for row in result.gap_after}
    most = max(100.0 * max(row.frf_error, row.floor) for row in before) * 1.05
    scale = (WIDTH - _LEFT - _RIGHT) / max(most, 1e-9)
    parts = [
        f'<circle cx="{_LEFT + 6:g}" cy="10" r="5" fill="{MODEL}"/>',
        text(_LEFT + 16.0, 14.0, "before"),
        f'<circle cx="{_LEFT + 86:g}" cy="10" r="5" fill="{DRIVEN}"/>',
        text(_LEFT + 96.0, 14.0, "after"),
        f'<path d="M{_LEFT + 156:g} 2v16" stroke="{INK}" stroke-width="2"/>',
        text(_LEFT + 164.0, 14.0, "expected"),
    ]
    y = 24.0 + 0.5 * _ROW
    for row in before:
        name = f"{row.posture}{' *' if row.held_out else ''}"
        parts.append(text(_LEFT - 8.0, y + 4.0, name, anchor="end"))
        parts.append(f'<path d="M{_LEFT} {number(y)}H{WIDTH - _RIGHT:g}" stroke="{GRID}"/>')
        x = _LEFT + 100.0 * row.floor * scale
        parts.append(
            f'<path d="M{number(x)} {number(y - 8.0)}v16" stroke="{INK}" stroke-width="2"/>'
        )
        pairs = [(row, MODEL)]
        if row.posture in after:
            pairs.append((after[row.posture], DRIVEN))
        for one, colour in pairs:
            x = _LEFT + 100.0 * one.frf_error * scale
            parts.append(f'<circle cx="{number(x)}" cy="{number(y)}" r="5" fill="{colour}"/>')
        y += _ROW
    parts.append(text(_LEFT, y + 6.0, "0"))
    parts.append(text(WIDTH - _RIGHT, y + 6.0, f"{most:.2g} %", anchor="end"))
    return figure("".join(parts), y + 12.0, "FRF error by posture, before and after")


def disagreement_svgs(result: GapResult) -> list[tuple[tuple[float, float], str]]:
    """One map a band of where model and measurement disagree: (band in Hz, SVG)."""
    return [
        (band, _map([cell for cell in result.where if cell.band_hz == band]))
        for band in sorted({cell.band_hz for cell in result.where})
    ]


def _map(cells: Sequence[Disagreement]) -> str:
    """Postures downwards, points and their axes across; the shade doubles its ratio each step."""
    postures = list(dict.fromkeys(cell.posture for cell in cells))
    columns = list(dict.fromkeys((cell.point, cell.axis) for cell in cells))
    wide = (WIDTH - _LEFT - _RIGHT) / len(columns)
    parts = []
    for posture in postures:
        y = _ROW * postures.index(posture)
        parts.append(text(_LEFT - 8.0, y + 16.0, posture, anchor="end"))
    for cell in cells:
        x = _LEFT + wide * columns.index((cell.point, cell.axis))
        y = _ROW * postures.index(cell.posture)
        told = shown(f"{cell.posture}, {cell.point} {cell.axis}: {cell.ratio:.2g}")
        parts.append(
            f'<rect x="{number(x)}" y="{number(y)}" width="{wide + 0.3:.2f}" '
            f'height="{_ROW - 1.0:g}" fill="{_shade(cell.ratio)}"><title>{told}</title></rect>'
        )
    bottom = _ROW * len(postures)
    said = list(dict.fromkeys(point for point, _ in columns))
    every = int(np.ceil(len(said) / 18))  # numbers of points that fit below
    for point in said[::every]:
        at = [k for k, column in enumerate(columns) if column[0] == point]
        x = _LEFT + wide * (float(np.mean(at)) + 0.5)
        parts.append(text(x, bottom + 13.0, point, anchor="middle"))
    y = bottom + 20.0
    for k, shade in enumerate(_SHADES):
        x = _LEFT + 52.0 * k
        parts.append(f'<rect x="{x:g}" y="{y:g}" width="14" height="12" fill="{shade}"/>')
        least = _FIRST_SHADE * 2.0 ** (k - 1)
        parts.append(text(x + 18.0, y + 11.0, "≤ 1" if k == 0 else f"> {least:g}"))
    return figure("".join(parts), y + 16.0, "where model and measurement disagree, by point")


def _shade(ratio: float) -> str:
    if ratio <= _FIRST_SHADE:
        return _SHADES[0]
    steps = int(np.floor(np.log2(ratio / _FIRST_SHADE))) + 1
    return _SHADES[min(steps, len(_SHADES) - 1)]
