"""The figures that are claimed of the workflow, maker by maker, from the lines of their studies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from armodal.study.kept_lines import Line
from armodal.study.score import rate
from armodal.study.tables import StudyTable

__all__ = ["claims"]

_MAIN_JOINTS = 3
_SINGLE = {
    "clear, right and alone": ("clear", "90 %"),
    "medium": ("medium", "75 %"),
    "faint": ("faint", ""),
}


def claims(studies: Mapping[str, Sequence[Line]]) -> StudyTable:
    """Return the table of what was reached and wanted.

    Parameters
    ----------
    studies
        Lines of each maker's study, by its name.
    """
    judged = {name: [x for x in own if "error" not in x] for name, own in studies.items()}
    columns = [*judged.values(), [x for own in judged.values() for x in own]]
    rows = _verdicts(columns) + _stiffness(columns) + _sizes(columns) + _times(columns)
    return StudyTable(
        title="Figures by maker", head=("", *judged, "together", "wanted"), rows=tuple(rows)
    )


def _verdicts(columns: Sequence[Sequence[Line]]) -> list[tuple[str, ...]]:
    def nulls(lines: Sequence[Line]) -> list[Line]:
        return [x for x in lines if not x["true"] and x["magnitude"] == "none"]

    def effects(lines: Sequence[Line]) -> list[Line]:
        return [x for x in lines if x["magnitude"] != "none"]

    def of_size(lines: Sequence[Line], size: str) -> list[Line]:
        return [x for x in lines if x["magnitude"] == size and len(x["true"]) == 1]

    rows = [
        ("nulls silent", *(_right(nulls(x)) for x in columns), "95 %"),
        ("— a wrong name", *(_wrong(nulls(x)) for x in columns), "1 %"),
    ]
    for words, (size, wanted) in _SINGLE.items():
        rows.append((words, *(_right(of_size(x, size)) for x in columns), wanted))
    pairs = [[x for x in own if len(x["true"]) == 2] for own in columns]
    outside = [[x for x in own if x["true_verdict"] == "outside_library"] for own in columns]
    rows += [
        ("two at once, both named", *(_right(x) for x in pairs), "70 %"),
        ("outside the library, said so", *(_right(x) for x in outside), "85 %"),
        ("wrong or surplus names, effects", *(_wrong(effects(x)) for x in columns), "2 %"),
    ]
    return rows


def _stiffness(columns: Sequence[Sequence[Line]]) -> list[tuple[str, ...]]:
    def rows_of(lines: Sequence[Line], *, right: bool) -> list[Line]:
        used = [x for x in lines if x["outcome"] == "right" or not right]
        return [row for x in used for row in x["stiffness"][:_MAIN_JOINTS]]

    def covered(rows: Sequence[Line]) -> str:
        return _of(sum(row["low"] <= row["true"] <= row["high"] for row in rows), len(rows))

    every = [rows_of(own, right=False) for own in columns]
    right = [rows_of(own, right=True) for own in columns]
    errors = [[abs(row["k"] / row["true"] - 1.0) for row in own] for own in right]
    widths = [[float(np.log(row["high"] / row["low"])) / 2.0 for row in own] for own in every]
    return [
        (
            "k of joints 1 to 3, median error (right verdicts)",
            *(_percent(own, 2) for own in errors),
            "1.5 %",
        ),
        ("— its range covers, every verdict", *(covered(own) for own in every), "92 to 98 %"),
        ("— half width of the range, median", *(_percent(own, 0) for own in widths), "15 %"),
    ]


def _sizes(columns: Sequence[Sequence[Line]]) -> list[tuple[str, ...]]:
    cells = []
    for own in columns:
        rows = [row for x in own if x["outcome"] == "right" for row in x["sizes"]]
        cells.append(_of(sum(row["low"] <= row["true"] <= row["high"] for row in rows), len(rows)))
    return [("size of a named effect in its 95 % interval", *cells, "90 to 98 %")]


def _times(columns: Sequence[Sequence[Line]]) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for words, null in (("processor time of a null, median, most", True), ("of an effect", False)):
        cells = []
        for own in columns:
            spent = [x["cpu_s"] for x in own if (x["magnitude"] == "none") == null]
            cells.append(f"{np.median(spent):.0f}, {max(spent):.0f} s" if spent else "")
        rows.append((words, *cells, "10, 30 s"))
    return rows


def _right(lines: Sequence[Line]) -> str:
    return _of(sum(x["outcome"] == "right" for x in lines), len(lines))


def _wrong(lines: Sequence[Line]) -> str:
    return _of(sum(x["outcome"] == "wrong name" for x in lines), len(lines))


def _of(k: int, n: int) -> str:
    if not n:
        return ""
    exact = rate(k, n)
    return f"{k} of {n} ({100 * exact.low:.0f} to {100 * exact.high:.0f} %)"


def _percent(values: Sequence[float], digits: int) -> str:
    return f"{100 * float(np.median(values)):.{digits}f} %" if values else ""
