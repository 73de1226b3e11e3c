"""What `armodal gap` says, on one screen: verdict, effects, before and after, where, rivals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from armodal.analyzer.gap.records import Interval
from armodal.analyzer.report.effect_words import chance, interval_in_words
from armodal.tui.screens.review.next_test import next_test_of

__all__ = ["gap_view"]

VERDICTS = {
    "named": "NAMED",
    "ambiguous": "AMBIGUOUS",
    "nothing_detectable": "NOTHING DETECTABLE",
    "outside_library": "OUTSIDE THE LIBRARY",
}
_SHADES = " ░▒▓█"
_CELL, _LABEL = 3, 22  # characters: 18 points beside their label fit 80 columns


def gap_view(found: Mapping[str, Any]) -> RenderableType:
    """Return everything of the object `armodal gap --json` prints; what is absent is left out."""
    verdict = str(found.get("verdict", "no verdict"))
    parts: list[RenderableType] = [Text(VERDICTS.get(verdict, verdict), style="bold reverse")]
    if found.get("summary"):
        parts.append(Text(str(found["summary"])))
    for section in _SECTIONS:
        part = section(found)
        if part is not None:
            parts += [Text(""), part]
    if found.get("arm_file"):
        parts += [Text(""), Text(f"new arm file: {found['arm_file']}")]
    return Group(*parts)


def _rows(found: Mapping[str, Any], key: str) -> list[Mapping[str, Any]]:
    value = found.get(key)
    rows = value if isinstance(value, Sequence) and not isinstance(value, str) else []
    return [row for row in rows if isinstance(row, Mapping)]


def _number(value: object, digits: int = 4) -> str:
    return f"{value:.{digits}g}" if isinstance(value, (int, float)) else "-"


def _parameters(row: Mapping[str, Any]) -> list[str]:
    """Lines of an effect's parameters, as the kept file has them or as `gap --json` prints them."""
    told = []
    for name, value in row.get("parameters", {}).items():
        found = value if isinstance(value, Mapping) else _interval(row, name, value)
        unit = f" {found.get('unit', '')}".rstrip()
        stiffness = _as_stiffness(found)
        if stiffness is not None:
            told.append(stiffness)
            continue
        low, high = _number(found.get("low")), _number(found.get("high"))
        spread = _number(found.get("std"), 2)
        told.append(f"{name} {_number(found['value'])} ± {spread}{unit} (95 %: {low} to {high})")
    return told


def _as_stiffness(found: Mapping[str, Any]) -> str | None:
    """A compliance as the stiffness it is; None of anything else."""
    numbers = {key: found.get(key) for key in ("value", "std", "low", "high")}
    told = {key: x for key, x in numbers.items() if isinstance(x, (int, float)) and x > 0.0}
    if found.get("unit") != "rad/(N m)" or len(told) < len(numbers):
        return None
    return interval_in_words(Interval(unit="rad/(N m)", **told))


def _interval(row: Mapping[str, Any], name: str, value: object) -> Mapping[str, Any]:
    low, high = row.get("interval_95", {}).get(name, (None, None))
    std, unit = (row.get(key, {}).get(name) for key in ("std", "units"))
    return {"value": value, "std": std, "unit": unit or "", "low": low, "high": high}


def _table(*columns: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, expand=False, padding=(0, 1), pad_edge=False)
    for column in columns:
        table.add_column(column)
    return table


def _add(table: Table, *cells: str) -> None:
    table.add_row(*map(Text, cells))  # brackets in a name are no markup


def _titled(title: str, table: RenderableType, below: str = "") -> RenderableType:
    parts: list[RenderableType] = [Text(title, style="bold"), table]
    return Group(*parts, Text(below, style="italic")) if below else Group(*parts)


def _name(row: Mapping[str, Any]) -> str:
    title, place = row.get("title") or row.get("name", "?"), row.get("place")
    return f"{title}, {place}" if place else str(title)


def _effects(found: Mapping[str, Any]) -> RenderableType | None:
    lines: list[tuple[str, str] | str] = []
    for row in _rows(found, "effects"):
        sure = row.get("confidence")
        told = f", {_sure(sure)} sure" if isinstance(sure, (int, float)) else ""
        lines.append((f"{_name(row)}{told}\n", "bold"))
        lines += [f"  {parameter}\n" for parameter in _parameters(row)]
        described = row.get("description")
        if isinstance(described, Mapping):
            lines += [f"  {name}: {_told(value)}\n" for name, value in described.items()]
        confused = row.get("confused_with")
        if isinstance(confused, (list, tuple)) and confused:
            lines.append(f"  could be confused with {', '.join(map(str, confused))}\n")
        if row.get("remedy"):
            lines.append(f"  do now: {row['remedy']}\n")
    return Text.assemble(*lines) if lines else None


def _sure(share: float) -> str:
    return "more than 99 %" if share > 0.99 else f"{100 * share:.0f} %"


def _error(row: Mapping[str, Any] | None) -> float | None:
    value = None if row is None else row.get("frf_error")
    return float(value) if isinstance(value, (int, float)) else None


def _before_after(found: Mapping[str, Any]) -> RenderableType | None:
    before, after = _rows(found, "gap_before"), _rows(found, "gap_after")
    if not before:
        return None
    later = {row.get("posture"): row for row in after}
    table = _table("posture", "before", "after", "noise alone", "")
    for row in before:
        then = later.get(row.get("posture"))
        shown = [
            f"{100 * value:.1f}" if isinstance(value, (int, float)) else "-"
            for value in (_error(row), _error(then), row.get("floor"))
        ]
        held = "not fitted to" if row.get("held_out") else "fitted"
        _add(
            table, str(row.get("posture", "?")), *shown, f"{_bar(_error(row), _error(then))} {held}"
        )
    return _titled(
        "Gap: difference over the FRFs, %",
        table,
        "noise alone: what scatter and the errors that every test has would leave",
    )


def _bar(before: float | None, after: float | None) -> str:
    """Before as light, what is left after as full blocks, of ten."""
    if before is None or after is None or before <= 0.0:
        return ""
    left = min(round(10 * after / before), 10)
    return "█" * left + "░" * (10 - left)


def gap_map(found: Mapping[str, Any]) -> RenderableType | None:
    """Disagreement over posture and band against point: the worst axis of each, shaded.

    1 is what scatter and allowance explain.
    """
    rows = [row for row in _rows(found, "where") if isinstance(row.get("ratio"), (int, float))]
    if not rows:
        return None
    points = list(dict.fromkeys(str(row.get("point")) for row in rows))
    lines = list(dict.fromkeys((str(row.get("posture")), _band(row)) for row in rows))
    worst = np.full((len(lines), len(points)), np.nan)
    for row in rows:
        at = lines.index((str(row.get("posture")), _band(row))), points.index(str(row.get("point")))
        worst[at] = np.nanmax([worst[at], float(row["ratio"])])
    names = [f"{posture} {band}"[:_LABEL] for posture, band in lines]
    wide = max(len(name) for name in names) + 1
    text = Text(" " * wide + "".join(point[-_CELL + 1 :].rjust(_CELL) for point in points))
    for name, values in zip(names, worst, strict=True):
        text.append(f"\n{name.ljust(wide)}")
        for value in values:
            text.append_text(_shaded(float(value)))
    limits = zip(_SHADES[1:], (1, 2, 4, 8), strict=True)
    text.append(
        "\nshade: "
        + ", ".join(f"{shade} from {limit}" for shade, limit in limits)
        + "; - not measured; 99 is 99 or more",
        style="italic",
    )
    return _titled("Where: difference over what scatter explains (1), worst axis, by point", text)


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


def _rivals(found: Mapping[str, Any]) -> RenderableType | None:
    rows = _rows(found, "rivals")
    if not rows:
        return None
    table = _table("effect", "by chance", "stands", "told apart by")
    for row in rows[:12]:
        stands = row.get("standing")
        _add(
            table,
            _name(row),
            chance(_probability(row.get("false_name_probability"))),
            "-" if stands is None else "yes" if stands else "no",
            str(row.get("told_by", "")),
        )
    return _titled("Rivals, best first", table)


def _probability(value: object) -> float | None:
    return float(value) if isinstance(value, (int, float)) else None


def _stiffness(found: Mapping[str, Any]) -> RenderableType | None:
    value = found.get("joint_stiffness_ranges")
    rows: list[tuple[str, str, str]] = []
    if isinstance(value, Mapping):
        for joint, row in value.items():
            if isinstance(row, Mapping):
                rows.append((str(joint), _k(row), _range(row.get("low"), row.get("high"))))
            elif isinstance(row, Sequence) and len(row) == 2:
                rows.append((str(joint), "-", _range(*row)))
    rows += [
        (str(row.get("joint", "?")), _k(row), _range(row.get("low"), row.get("high")))
        for row in _rows(found, "joint_stiffness_ranges")
    ]
    if not rows:
        return None
    table = _table("joint", "k", "range")
    for cells in rows:
        _add(table, *cells)
    return _titled("Joint stiffness over all rivals still standing, N m/rad", table)


def _k(row: Mapping[str, Any]) -> str:
    value = row.get("k_n_m_per_rad")
    return f"{value:.0f}" if isinstance(value, (int, float)) else "-"


def _range(low: object, high: object) -> str:
    if not isinstance(low, (int, float)) or not isinstance(high, (int, float)):
        return "unknown"
    return f"{low:.0f} to {high:.0f}"


def _next_test(found: Mapping[str, Any]) -> RenderableType | None:
    test = next_test_of(found)
    if test is None:
        return None
    told = Text("Next test: ", style="bold").append(str(test.get("words", "not told")))
    if test.get("why"):
        told.append(f"\n  why: {test['why']}", style="not bold")
    if isinstance(test.get("gain"), (int, float)):
        told.append(f"\n  expected gain: {_number(test['gain'], 3)} nats of evidence", "not bold")
    return told.append("\n  n: write it as a plan, and measure it", style="not bold")


def _told(value: object) -> str:
    if isinstance(value, (list, tuple)):
        return ", ".join(_told(part) for part in value)
    return _number(value) if isinstance(value, float) else str(value)


def _hidden(found: Mapping[str, Any]) -> RenderableType | None:
    rows = _rows(found, "hidden")
    if not rows:
        return None
    table = _table("effect", "place", "parameter", "at most", "")
    for row in rows:
        cells = (str(row.get(key, "?")) for key in ("name", "place", "parameter"))
        _add(table, *cells, _number(row.get("largest")), str(row.get("unit", "")))
    return _titled("Could still hide, 95 %", table)


def _evidence(found: Mapping[str, Any]) -> RenderableType | None:
    lines = [f"Departs at: {found['interface']}"] if found.get("interface") else []
    lines += [
        f"check {row.get('check')}: {row.get('outcome')} {row.get('words', '')}"
        for row in _rows(found, "gates")
    ]
    notes = found.get("notes")
    lines += [f"note: {note}" for note in notes] if isinstance(notes, (list, tuple)) else []
    return Text("\n".join(lines)) if lines else None


_SECTIONS = (
    _effects,
    _next_test,
    _before_after,
    gap_map,
    _rivals,
    _stiffness,
    _hidden,
    _evidence,
)
