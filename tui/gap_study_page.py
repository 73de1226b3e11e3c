"""A study's tables and curves as a page of Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from armodal.analyzer.gap.score import OUTCOMES
from armodal.tui.pace import REFERENCE_S

__all__ = ["study_page"]

Line = dict[str, Any]


def study_page(summary: Line, curves: Sequence[Line], command: str) -> str:
    """Return the page: verdicts, confusion, detection, figures, further tests, curves.

    Parameters
    ----------
    command
        That made it, seeds and all.
    """
    parts = ["# Tables of the gap study", f"Made by\n\n    {command}", "## Verdicts"]
    parts.append(
        _table(
            ["cases", "n", "right", "95 %", *OUTCOMES[1:], "at most, 95 %", "s, median, most"],
            [
                [name, g["n"], g["right"]["k"], _between(g["right"])]
                + [g[outcome] for outcome in OUTCOMES[1:]]
                + [f"{100 * g['wrong']['high']:.0f} %", "{:.0f}, {:.0f}".format(*g["cpu_s"])]
                for name, g in summary["groups"].items()
                if g["n"]
            ],
        )
    )
    said = [
        [truth, ", ".join(f"{name} {n}" for name, n in row.items())]
        for truth, row in sorted(summary["confusion"].items())
    ]
    parts += ["## What was said of single effects", _table(["truth", "said"], said)]
    detection = [
        [f"{row['size']:.2f}", row["n"], row["said"]["k"], row["right"]["k"]]
        for row in summary["detection"]
    ]
    parts += [
        "## Detection over the effect's size",
        _table(["size, clear is 1", "n", "something said", "said right"], detection),
        "## Figures",
        _table(["figure", "reached"], _figures(summary)),
    ]
    if summary["tests"]["n"]:
        parts += ["## Further tests", _table(["figure", "reached"], _tests(summary["tests"]))]
    if curves:
        parts += [
            "## Learning curves",
            (
                "Of the rest the plan has all: 5 postures, 18 points, 3 hits. The width of a "
                "joint's range is half of ln(high / low), median over joints and cases."
            ),
            _table(
                ["varied", "n", "cases", "right", "wrong", "evidence", "size's std", "range of k"],
                [_curve(row) for row in curves],
            ),
        ]
    return "\n\n".join(parts) + "\n"


def _table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def _between(rate: Line) -> str:
    return f"{100 * rate['low']:.0f} to {100 * rate['high']:.0f} %"


def _covered(rate: Line) -> str:
    return f"{rate['k']} of {rate['n']} ({_between(rate)})" if rate else "none"


def _figures(summary: Line) -> list[list[object]]:
    ratio, worst = (summary[f"held_out_over_true_model_{x}"] for x in ("median", "worst"))
    spent = f"{summary['cpu_s_median']:.0f} s, {summary['cpu_s_most']:.0f} s"
    gap = " to ".join(f"{100 * summary['gap'][when]:.1f} %" for when in ("before", "after"))
    return [
        ["held-out FRF error of effects named right, median", gap],
        ["size of a named effect, median error", f"{100 * summary['size_error_median']:.1f} %"],
        ["its 95 % interval covers", _covered(summary["size_covered"])],
        ["stiffness of joints 1 to 3, median error", f"{100 * summary['k_error_median']:.2f} %"],
        ["95 % interval of any joint's covers", _covered(summary["k_covered"])],
        ["where the verdict is right", _covered(summary["k_covered_where_right"])],
        ["its range covers", _covered(summary["k_range_covers"])],
        ["held-out FRF error over the true model's, median, worst", f"{ratio:.2f}, {worst:.2f}"],
        ["ambiguous sets hold the truth", _covered(summary["ambiguous_holds_truth"])],
        ["processor time a case, median, most", spent],
        *_at_reference(summary),
        ["cases refused", len(summary["failed"])],
    ]


def _at_reference(summary: Line) -> list[list[object]]:
    if "pace_median" not in summary:
        return []
    what = (
        f"likewise at the pace of a core that sums a million squares in {REFERENCE_S:.3f} s; "
        f"here they took {summary['pace_median']:.2f} times that, median"
    )
    spent = f"{summary['reference_s_median']:.0f} s, {summary['reference_s_most']:.0f} s"
    return [[what, spent]]


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
