"""A study's tables and curves, as words that a page and a terminal show alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from armodal.study.kept_lines import Line
from armodal.study.pace import REFERENCE_S
from armodal.study.score import OUTCOMES

__all__ = ["StudyTable", "confidence_table", "study_tables"]


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyTable:
    """One table, a column for every word of its head."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


def study_tables(summary: Line, curves: Sequence[Line] = ()) -> list[StudyTable]:
    """Return the tables: verdicts, confusion, detection, confidence, figures, tests, curves.

    Parameters
    ----------
    summary
        Of `study_summary`.
    curves
        Rows of `curve_rows`.
    """
    verdicts = [
        [name, g["n"], g["right"]["k"], _between(g["right"])]
        + [g[outcome] for outcome in OUTCOMES[1:]]
        + [f"{100 * g['wrong']['high']:.0f} %", _seconds(*g["cpu_s"])]
        for name, g in summary["groups"].items()
        if g["n"]
    ]
    said = [
        [truth, ", ".join(f"{name} {n}" for name, n in row.items())]
        for truth, row in sorted(summary["confusion"].items())
    ]
    detection = [
        [f"{row['size']:.2f}", row["n"], row["said"]["k"], row["right"]["k"]]
        for row in summary["detection"]
    ]
    tables = [
        _table(
            "Verdicts",
            ("cases", "n", "right", "95 %", *OUTCOMES[1:], "at most, 95 %", "time, median, most"),
            verdicts,
        ),
        _table("What was said of single effects", ("truth", "said"), said),
        _table(
            "Detection over the effect's size",
            ("size, clear is 1", "n", "something said", "said right"),
            detection,
        ),
        confidence_table(summary["reliability"]),
        _table("Figures", ("figure", "reached"), _figures(summary)),
    ]
    if summary["tests"]["n"]:
        tables.append(_table("Further tests", ("figure", "reached"), _tests(summary["tests"])))
    if curves:
        tables.append(
            _table(
                "Learning curves",
                ("varied", "n", "cases", "right", "wrong", "evidence", "size's std", "range of k"),
                [_curve(row) for row in curves],
                note="Of the rest the plan has all: 5 postures, 18 points, 3 hits. The width of a "
                "joint's range is half of ln(high / low), median over joints and cases.",
            )
        )
    return tables


def confidence_table(bins: Sequence[Line]) -> StudyTable:
    """Return names by the confidence they were given, bins as records (`reliability`)."""
    rows = [
        [
            f"{100 * own['low']:.1f} to {100 * own['high']:.1f} %",
            f"{100 * own['stated']:.1f} %",
            own["right"]["n"],
            own["right"]["k"],
            _between(own["right"]),
        ]
        for own in bins
    ]
    return _table("Stated confidence", ("stated", "mean", "names", "right", "95 %"), rows)


def _table(
    title: str, head: tuple[str, ...], rows: Sequence[Sequence[object]], *, note: str = ""
) -> StudyTable:
    words = tuple(tuple(str(cell) for cell in row) for row in rows)
    return StudyTable(title=title, head=head, rows=words, note=note)


def _between(rate: Line) -> str:
    return f"{100 * rate['low']:.0f} to {100 * rate['high']:.0f} %"


def _percent(value: float, digits: int) -> str:
    return "-" if np.isnan(value) else f"{100 * value:.{digits}f} %"


def _seconds(median_s: float, most_s: float) -> str:
    return "-" if np.isnan(median_s) else f"{median_s:.0f} s, {most_s:.0f} s"


def _covered(rate: Line) -> str:
    return f"{rate['k']} of {rate['n']} ({_between(rate)})" if rate else "none"


def _figures(summary: Line) -> list[list[object]]:
    ratio, worst = (summary[f"held_out_over_true_model_{x}"] for x in ("median", "worst"))
    gap = " to ".join(_percent(summary["gap"][when], 1) for when in ("before", "after"))
    at_reference = (
        f"likewise at the pace of a core that sums a million squares in {REFERENCE_S:.3f} s; "
        f"here they took {summary['pace_median']:.2f} times that, median"
    )
    return [
        ["held-out FRF error of effects named right, median", gap],
        ["size of a named effect, median error", _percent(summary["size_error_median"], 1)],
        ["its 95 % interval covers", _covered(summary["size_covered"])],
        ["stiffness of joints 1 to 3, median error", _percent(summary["k_error_median"], 2)],
        ["95 % interval of any joint's covers", _covered(summary["k_covered"])],
        ["where the verdict is right", _covered(summary["k_covered_where_right"])],
        ["its range covers", _covered(summary["k_range_covers"])],
        [
            "held-out FRF error over the true model's, median, worst",
            "-" if np.isnan(ratio) else f"{ratio:.2f}, {worst:.2f}",
        ],
        ["ambiguous sets hold the truth", _covered(summary["ambiguous_holds_truth"])],
        [
            "processor time a case, median, most",
            _seconds(summary["cpu_s_median"], summary["cpu_s_most"]),
        ],
        [at_reference, _seconds(summary["reference_s_median"], summary["reference_s_most"])],
        ["cases refused", len(summary["failed"])],
    ]


def _tests(tests: Line) -> list[list[object]]:
    rows: list[list[object]] = [
        ["cases that asked for a test, of all", _covered(tests["asked"])],
        ["right after them, of clear ones", _covered(tests["clear"])],
        ["right after them, of medium ones", _covered(tests["medium"])],
        ["wrong names after them", tests["wrong"]],
    ]
    if tests["compared"]:
        asked, random = (f"{tests[k]:.0f}" for k in ("brought_asked", "brought_random"))
        what = f"evidence for the nearer to the truth in nats, {tests['compared']} cases, median"
        rows.append([f"{what}: asked, random", f"{asked}, {random}"])
        asked, random = (f"{x:.0f}" for x in tests["brought_in_all"])
        rows.append(["likewise, in all of them", f"{asked}, {random}"])
        twice = _covered(tests["brought_twice"])
        rows.append(["cases in which the asked test brought at least twice a random one's", twice])
    widths = tests["widths"]
    if widths["n"]:
        reached = ", ".join(f"{100 * widths[k]:.1f} %" for k in ("before", "asked", "random"))
        rows.append(
            [
                (
                    f"half width of a joint's range of k, {widths['n']} cases, median: before, "
                    "after the asked test, after a random one instead"
                ),
                reached,
            ]
        )
    return rows


def _curve(row: Line) -> list[object]:
    def percent(value: float | None) -> str:
        return "-" if value is None else f"{100 * value:.1f} %"

    gain = "-" if row["gain"] is None else f"{row['gain']:.0f}"
    return [
        *(row[key] for key in ("varied", "n", "cases", "right", "wrong")),
        gain,
        percent(row["size_std"]),
        percent(row["k_range"]),
    ]
