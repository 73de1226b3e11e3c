"""Is stated confidence true? Names by the confidence they were given, and how many were right.

A reliability diagram: Murphy and Winkler, J. Royal Statistical Society C 26 (1977) 41.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from armodal.study.kept_lines import Line
from armodal.study.score import Rate, rate

__all__ = ["Bin", "reliability", "reliability_svg"]

_BINS = 4  # at most, with names shared evenly
_FEWEST = 5  # names a bin
_LEAST, _MOST = 0.001, 0.5  # probability of being wrong, ends of both axes
_TICKS = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3)
_SIZE, _MARGIN = 420, 64  # px
_FONT = ' font-family="sans-serif" font-size="12"'


@dataclass(frozen=True, slots=True, kw_only=True)
class Bin:
    """Names of like confidence."""

    low: float
    high: float
    stated: float  # mean
    right: Rate


def reliability(lines: Sequence[Line]) -> list[Bin]:
    """Return names in bins of like confidence, the least sure first.

    A case counts as right if every name it has is true, and a single one at its true place.

    Parameters
    ----------
    lines
        Of a study, or of several.
    """
    told = [
        x
        for x in lines
        if "error" not in x and x["verdict"] == "named" and x["confidence"] is not None
    ]
    told.sort(key=lambda x: float(x["confidence"]))
    stated = [float(x["confidence"]) for x in told]
    right = [x["outcome"] != "wrong name" and x["place_right"] is not False for x in told]
    parts = max(min(_BINS, len(told) // _FEWEST), 1)
    ends = [k * len(told) // parts for k in range(parts + 1)]
    return [
        Bin(
            low=stated[a],
            high=stated[b - 1],
            stated=float(np.mean(stated[a:b])),
            right=rate(sum(right[a:b]), b - a),
        )
        for a, b in pairwise(ends)
        if a < b
    ]


def reliability_svg(bins: Sequence[Bin]) -> str:
    """Return the diagram: part that was wrong over the part stated to be, both on log scales.

    On the diagonal what is stated is true; above it names are surer than they should be.
    """
    inner = _SIZE - 2 * _MARGIN
    span = np.log(_MOST / _LEAST)

    def along(wrong: float) -> float:
        kept = min(max(wrong, _LEAST), _MOST)
        return float(np.log(kept / _LEAST) / span) * inner

    def x(wrong: float) -> str:
        return f"{_MARGIN + along(wrong):.1f}"

    def y(wrong: float) -> str:
        return f"{_SIZE - _MARGIN - along(wrong):.1f}"

    ends = x(_LEAST), y(_LEAST), x(_MOST), y(_MOST)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_SIZE} {_SIZE}"{_FONT}>',
        f'<rect width="{_SIZE}" height="{_SIZE}" fill="white"/>',
        _line(*ends, "#888", "4 4"),
        _line(ends[0], ends[1], ends[2], ends[1], "black"),
        _line(ends[0], ends[1], ends[0], ends[3], "black"),
    ]
    for wrong in _TICKS:
        percent = f"{100 * wrong:g} %"
        parts.append(_text(x(wrong), f"{_SIZE - _MARGIN + 18}", percent, "middle"))
        parts.append(_text(f"{_MARGIN - 8}", f"{float(y(wrong)) + 4:.1f}", percent, "end"))
    parts.append(_text(f"{_SIZE / 2}", f"{_SIZE - 16}", "stated to be wrong", "middle"))
    parts.append(
        f'<g transform="rotate(-90 16 {_SIZE / 2})">'
        + _text("16", f"{_SIZE / 2}", "wrong", "middle")
        + "</g>"
    )
    for number, own in enumerate(bins):
        at = x(1.0 - own.stated)
        parts.append(_line(at, y(1.0 - own.right.low), at, y(1.0 - own.right.high), "#1f5fa8"))
        level = y(1.0 - own.right.k / own.right.n)
        parts.append(f'<circle cx="{at}" cy="{level}" r="5" fill="#1f5fa8"/>')
        label = f"{own.right.k} of {own.right.n} right"
        above = float(level) - 8 - 16 * (number % 2)  # neighbours' labels in two rows
        parts.append(_text(f"{float(at) + 5:.1f}", f"{above:.1f}", label, "start"))
    return "\n".join([*parts, "</svg>"]) + "\n"


def _line(x1: str, y1: str, x2: str, y2: str, colour: str, dashes: str = "") -> str:
    dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
    return (
        f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" stroke="{colour}" stroke-width="1.5"'
        f"{dashed}/>"
    )


def _text(x: str, y: str, words: str, anchor: str) -> str:
    return f'<text x="{x}" y="{y}" text-anchor="{anchor}">{words}</text>'
