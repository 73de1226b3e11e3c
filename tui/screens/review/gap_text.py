"""What `armodal gap` says, on one screen: verdict, effects, before and after, where, rivals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from armodal.analyzer.gap.records import Interval, LineDeviation
from armodal.analyzer.report.effect_words import certainty, chance, hidden_in_words, mechanics
from armodal.protocols.printable import printable
from armodal.tui.fitting_table import FittingTable
from armodal.tui.screens.review.gap_map import gap_map
from armodal.tui.screens.review.next_test import next_test_of

__all__ = ["gap_view"]

VERDICTS = {
    "named": "NAMED",
    "ambiguous": "AMBIGUOUS",
    "nothing_detectable": "NOTHING DETECTABLE",
    "outside_library": "OUTSIDE THE LIBRARY",
}


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
    fitting = FittingTable(table) if isinstance(table, Table) else table
    parts: list[RenderableType] = [Text(title, style="bold"), fitting]
    return Group(*parts, Text(below, style="italic")) if below else Group(*parts)


def _name(row: Mapping[str, Any]) -> str:
    title, place = row.get("title") or row.get("name", "?"), row.get("place")
    return f"{title}, {place}" if place else str(title)


def _effects(found: Mapping[str, Any]) -> RenderableType | None:
    lines: list[tuple[str, str] | str] = []
    for row in _rows(found, "effects"):
        sure = row.get("confidence")
        told = f", {certainty(sure)} sure" if isinstance(sure, (int, float)) else ""
        lines.append((f"{_name(row)}{told}\n", "bold"))
        by_chance = row.get("false_name_probability")
        if isinstance(by_chance, (int, float)):
            lines.append(f"  by chance: {chance(by_chance)} of sessions without it look as clear\n")
        lines += [f"  {what}: {words}\n" for what, words in _mechanics(row)]
        if row.get("remedy"):
            lines.append(f"  do now: {row['remedy']}\n")
    return Text.assemble(*lines) if lines else None


def _mechanics(row: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The effect in the words of mechanics, as far as the result tells them."""
    described, confused = row.get("description"), row.get("confused_with")
    told = {
        name: value if isinstance(value, Mapping) else _interval(row, name, value)
        for name, value in row.get("parameters", {}).items()
    }
    whole, parts = {}, []
    for name, found in told.items():
        numbers = {key: found.get(key) for key in ("value", "std", "low", "high")}
        known = {key: float(x) for key, x in numbers.items() if isinstance(x, (int, float))}
        if len(known) == len(numbers):
            whole[name] = Interval(unit=str(found.get("unit") or ""), **known)
        else:
            unit = f" {found.get('unit') or ''}".rstrip()
            parts.append((name, f"{_number(found['value'])}{unit}, ± not told"))
    return [
        *parts,
        *mechanics(
            size=str(row.get("size", "")),
            parameters=whole,
            description=described if isinstance(described, Mapping) else {},
            line=_line(row.get("line")),
            words=_words(row.get("words")),
            details=[str(name) for name in row.get("details", ())],
            place=str(row.get("place") or ""),
            confused_with=[str(x) for x in confused] if isinstance(confused, (list, tuple)) else [],
            told_by=str(row.get("told_by") or ""),
        ),
    ]


def _line(told: object) -> LineDeviation | None:
    """An axis' deviations, where a result tells them."""
    if not isinstance(told, Mapping):
        return None
    turned, shifted = told.get("turned_rad"), told.get("shifted_m")
    if not isinstance(turned, (int, float)) or not isinstance(shifted, (int, float)):
        return None
    return LineDeviation(turned_rad=turned, shifted_m=shifted)


def _words(told: object) -> dict[str, str]:
    if not isinstance(told, Mapping):
        return {}
    return {str(name): str(words) for name, words in told.items()}


def _error(row: Mapping[str, Any] | None) -> float | None:
    value = None if row is None else row.get("frf_error")
    return float(value) if isinstance(value, (int, float)) else None


def _before_after(found: Mapping[str, Any]) -> RenderableType | None:
    before, after = _rows(found, "gap_before"), _rows(found, "gap_after")
    if not before:
        return None
    later = {row.get("posture"): row for row in after}
    table = _table("posture", "before", "after", "expected", "")
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
        (
            "expected: what scatter and a right model's allowance would leave.\n"
            "After as low as this: all is explained. Far above it: something is still missing."
        ),
    )


def _bar(before: float | None, after: float | None) -> str:
    """Before as light, what is left after as full blocks, of ten."""
    if before is None or after is None or before <= 0.0:
        return ""
    left = min(round(10 * after / before), 10)
    return "█" * left + "░" * (10 - left)


def _where(found: Mapping[str, Any]) -> RenderableType | None:
    cells = [row for row in _rows(found, "where") if isinstance(row.get("ratio"), (int, float))]
    title = "Where, before naming: over what is expected (1), worst axis, by point"
    return _titled(title, gap_map(cells)) if cells else None


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
    return _titled("Tried in the last round, best first", table)


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
    return told.append("\n  n: write it as a plan, and measure it", style="not bold")


def _hidden(found: Mapping[str, Any]) -> RenderableType | None:
    rows = _rows(found, "hidden")
    if not rows:
        return None
    table = _table("effect", "place", "parameter", "")
    for row in rows:
        what = str(row.get("title") or row.get("name", "?"))
        size, largest, unit = (row.get(key) for key in ("parameter", "largest", "unit"))
        told = str(size or "?"), "?"
        if isinstance(largest, (int, float)):
            told = hidden_in_words(told[0], largest, str(unit or ""))
        _add(table, what, str(row.get("place", "?")), str(row.get("words") or told[0]), told[1])
    return _titled("Could still hide, 95 %", table)


def _evidence(found: Mapping[str, Any]) -> RenderableType | None:
    lines = [f"Departs at: {found['interface']}"] if found.get("interface") else []
    lines += [
        f"check {row.get('check')}: {row.get('outcome')} {row.get('words', '')}"
        for row in _rows(found, "gates")
    ]
    notes = found.get("notes")
    lines += (
        [f"note: {printable(str(note), keep='')}" for note in notes]
        if isinstance(notes, (list, tuple))
        else []
    )
    return Text("\n".join(lines)) if lines else None


_SECTIONS = (
    _effects,
    _next_test,
    _before_after,
    _where,
    _rivals,
    _stiffness,
    _hidden,
    _evidence,
)
