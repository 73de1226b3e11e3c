"""Static figures as inline SVG: panels of curves over one shared frequency axis.

They print as vectors, need no script and keep their size in letters: a figure is WIDTH units wide
and is shown about as wide as a hand.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.report.page_text import shown
from armodal.analyzer.report.palette import GRID, INK

__all__ = ["LETTER", "WIDTH", "Curve", "Panel", "figure", "number", "panels_figure", "text"]

Array = npt.NDArray[np.float64]

WIDTH = 440.0  # units; letters are LETTER of them high
LETTER = 12.0
_LEFT, _RIGHT, _TOP, _BOTTOM, _BETWEEN = 52.0, 14.0, 8.0, 34.0, 14.0
_LINE_HEIGHT = 16.0  # of the legend
_CHARACTER = 6.4  # width of a letter of LETTER units, on average
_MOST_TICKS = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """One curve of a panel; NaN breaks it. Without a name it is not in the legend."""

    x: Array
    y: Array
    colour: str
    name: str = ""
    width: float = 1.4
    dash: str = ""
    opacity: float = 1.0
    dots: bool = False  # dots in place of a line


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """One panel: its curves, its height in units and its ordinate.

    What lies outside the range is not drawn.
    """

    curves: tuple[Curve, ...]
    height: float
    label: str
    y_range: tuple[float, float]
    log: bool = False
    ticks: tuple[float, ...] = ()  # empty: chosen


def panels_figure(
    panels: Sequence[Panel],
    x_range: tuple[float, float],
    *,
    x_label: str,
    title: str,
    verticals: Sequence[float] = (),
) -> str:
    """Panels one below the other over the same linear abscissa, with a legend.

    Parameters
    ----------
    verticals
        Abscissae of thin lines through all panels, such as natural frequencies.
    """
    named = [curve for panel in panels for curve in panel.curves if curve.name]
    legend, top = _legend(named)
    parts = [legend]
    for panel in panels:
        last = panel is panels[-1]
        parts.append(_panel(panel, x_range, top, verticals, x_label if last else None))
        top += panel.height + _BETWEEN
    return figure("".join(parts), top - _BETWEEN + _BOTTOM, title)


def figure(content: str, height: float, title: str, width: float = WIDTH) -> str:
    """An SVG element with a name for those who cannot see it."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" role="img" '
        f'font-size="{LETTER:g}" fill="{INK}"><title>{shown(title)}</title>{content}</svg>'
    )


def text(x: float, y: float, said: str, *, anchor: str = "start", more: str = "") -> str:
    """A line of text; `more` holds further attributes."""
    return (
        f'<text x="{number(x)}" y="{number(y)}" text-anchor="{anchor}" {more}>{shown(said)}</text>'
    )


def number(value: float) -> str:
    """A coordinate to a tenth of a unit."""
    return f"{value:.1f}".removesuffix(".0")


def _legend(curves: Sequence[Curve]) -> tuple[str, float]:
    """The legend's rows, and where the first panel begins."""
    parts, x, y = [], _LEFT, _TOP
    for curve in curves:
        long = 26.0 + _CHARACTER * len(curve.name)
        if x > _LEFT and x + long > WIDTH - _RIGHT:
            x, y = _LEFT, y + _LINE_HEIGHT
        middle = y + 4.0
        parts.append(
            f'<path d="M{number(x)} {number(middle)}h18" stroke="{curve.colour}" fill="none" '
            f'stroke-width="{max(curve.width, 1.4):g}" stroke-dasharray="{curve.dash}" '
            f'opacity="{max(curve.opacity, 0.5):g}"/>' + text(x + 22.0, middle + 4.0, curve.name)
        )
        x += long + 10.0
    return "".join(parts), y + (_LINE_HEIGHT if curves else 0.0)


def _panel(
    panel: Panel,
    x_range: tuple[float, float],
    top: float,
    verticals: Sequence[float],
    x_label: str | None,
) -> str:
    bottom, right = top + panel.height, WIDTH - _RIGHT
    scale = (right - _LEFT) / (x_range[1] - x_range[0])
    low, high = (math.log10(y) if panel.log else y for y in panel.y_range)

    def across(x: Array) -> Array:
        return np.asarray(_LEFT + (x - x_range[0]) * scale)

    def up(y: Array) -> Array:
        if panel.log:
            y = np.log10(np.where(y > 0.0, y, np.nan))
        share = (y - low) / (high - low)
        within = (share >= 0.0) & (share <= 1.0)
        return np.asarray(np.where(within, bottom - share * panel.height, np.nan))

    parts = []
    for tick in panel.ticks or (_decades(*panel.y_range) if panel.log else _round_ticks(low, high)):
        y = float(up(np.array([tick]))[0])
        parts.append(f'<path d="M{_LEFT} {number(y)}H{number(right)}" stroke="{GRID}"/>')
        parts.append(text(_LEFT - 5.0, y + 4.0, _told(tick), anchor="end"))
    for tick in _round_ticks(*x_range):
        x = float(across(np.array([tick]))[0])
        parts.append(f'<path d="M{number(x)} {number(top)}V{number(bottom)}" stroke="{GRID}"/>')
        if x_label is not None:
            parts.append(text(x, bottom + 14.0, _told(tick), anchor="middle"))
    for at in verticals:
        if x_range[0] <= at <= x_range[1]:
            x = float(across(np.array([at]))[0])
            parts.append(
                f'<path d="M{number(x)} {number(top)}V{number(bottom)}" stroke="{INK}" '
                'stroke-width=".7" stroke-dasharray="1 3"/>'
            )
    parts += [_curve(curve, across(curve.x), up(curve.y)) for curve in panel.curves]
    middle = top + 0.5 * panel.height
    turned = f'transform="rotate(-90 12 {number(middle)})"'
    parts.append(text(12.0, middle, panel.label, anchor="middle", more=turned))
    if x_label is not None:
        parts.append(text(0.5 * (_LEFT + right), bottom + 29.0, x_label, anchor="middle"))
    return "".join(parts)


def _curve(curve: Curve, x: Array, y: Array) -> str:
    told = np.isfinite(x) & np.isfinite(y)
    style = f'stroke="{curve.colour}" opacity="{curve.opacity:g}"'
    if curve.dots:
        dots = "".join(f"M{number(a)} {number(b)}h0" for a, b in zip(x[told], y[told], strict=True))
        return f'<path d="{dots}" {style} stroke-width="3" stroke-linecap="round" fill="none"/>'
    steps, pen = [], "M"
    for a, b, here in zip(x, y, told, strict=True):
        if here:
            steps.append(f"{pen}{number(a)} {number(b)}")
        pen = "L" if here else "M"
    return (
        f'<path d="{"".join(steps)}" {style} stroke-width="{curve.width:g}" fill="none" '
        f'stroke-dasharray="{curve.dash}" stroke-linejoin="round"/>'
    )


def _round_ticks(low: float, high: float) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten within the range, at most _MOST_TICKS."""
    rough = (high - low) / _MOST_TICKS
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= rough * (1.0 - 1e-9))
    return [i * step for i in range(math.ceil(low / step), math.floor(high / step) + 1)]


def _decades(low: float, high: float) -> list[float]:
    first, last = math.ceil(math.log10(low)), math.floor(math.log10(high))
    skip = max(1, math.ceil((last - first) / _MOST_TICKS))
    return [10.0**power for power in range(first, last + 1, skip)]


def _told(tick: float) -> str:
    return f"{tick:.4g}".replace("e-0", "e-").replace("e+0", "e")
