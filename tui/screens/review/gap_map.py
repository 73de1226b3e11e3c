"""Where model and measurement disagree, as a map of shaded numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from rich.text import Text

from armodal.tui.drawing import short_names

__all__ = ["gap_map"]

_SHADES = " ░▒▓█"
_CELL, _LABEL, _ACROSS = 3, 22, 18  # characters of a cell and a label; so many points in 80


def gap_map(rows: Sequence[Mapping[str, Any]]) -> Text:
    """Disagreement over posture and band against point: the worst axis of each, shaded.

    1 is what scatter and allowance explain.
    """
    points = list(dict.fromkeys(str(row.get("point")) for row in rows))
    lines = list(dict.fromkeys((str(row.get("posture")), _band(row)) for row in rows))
    worst = np.full((len(lines), len(points)), np.nan)
    for row in rows:
        at = lines.index((str(row.get("posture")), _band(row))), points.index(str(row.get("point")))
        worst[at] = np.nanmax([worst[at], float(row["ratio"])])
    postures = list(dict.fromkeys(posture for posture, _ in lines))
    longest = max(len(band) for _, band in lines)
    short = dict(zip(postures, short_names(postures, _LABEL - longest - 1), strict=True))
    names = [f"{short[posture]} {band}" for posture, band in lines]
    text = Text("\n").join(
        _part_of_map(names, points[start : start + _ACROSS], worst[:, start : start + _ACROSS])
        for start in range(0, len(points), _ACROSS)
    )
    limits = zip(_SHADES[1:], (1, 2, 4, 8), strict=True)
    text.append(
        "\nshade: "
        + ", ".join(f"{shade} from {limit}" for shade, limit in limits)
        + "; - not measured; 99 is 99 or more",
        style="italic",
    )
    return text


def _part_of_map(
    names: Sequence[str], points: Sequence[str], worst: npt.NDArray[np.float64]
) -> Text:
    """Some points of the map; names too long to stand across go downwards."""
    wide = max(map(len, names)) + 1
    longest = max(map(len, points))
    if longest < _CELL:
        heads = ["".join(point.rjust(_CELL) for point in points)]
    else:
        letters = zip(*(point.rjust(longest) for point in points), strict=True)
        heads = ["".join(letter.rjust(_CELL) for letter in row) for row in letters]
    text = Text("\n").join(Text(" " * wide + head) for head in heads)
    for name, values in zip(names, worst, strict=True):
        text.append(f"\n{name.ljust(wide)}")
        for value in values:
            text.append_text(_shaded(float(value)))
    return text


def _band(row: Mapping[str, Any]) -> str:
    band = row.get("band_hz")
    if isinstance(band, Sequence) and len(band) == 2:
        return f"{band[0]:.0f}-{band[1]:.0f}"
    return ""


def _shaded(ratio: float) -> Text:
    if not np.isfinite(ratio):
        return Text("-".rjust(_CELL), style="dim")
    level = int(np.clip(np.floor(np.log2(max(ratio, 0.5))) + 1, 0, 4))
    number = str(min(int(ratio), 99)).rjust(_CELL - 1)
    return Text(f"{_SHADES[level]}{number}", style="bold" if level >= 3 else "")
