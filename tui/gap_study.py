"""`armodal gap-study`: sealed cases through the gap workflow, and how often it was right.

The hashes of all truths are told before the first verdict. A finished case is a line of the
study's file, so that a study that was stopped goes on where it was.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import asdict
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from rich.table import Table

from analyzer.gap.score import OUTCOMES, mark, rate, size_found, size_of_truth
from analyzer.gap.workflow import find_gap
from hil_sim.study import CaseSpec, sealed
from protocols.errors import ArmodalError

__all__ = ["run_case", "run_study", "seal_hashes", "study_summary", "study_tables"]

Line = dict[str, Any]


def seal_hashes(specs: Sequence[CaseSpec]) -> dict[int, str]:
    """Return the hash of every case's truth, by number."""
    return {spec.number: sealed(spec).truth_sha256 for spec in specs}


def run_case(spec: CaseSpec) -> Line:
    """Make a case, judge it, open its truth, mark it."""
    case = sealed(spec)
    session = case.session()
    begin = process_time()
    try:
        outcome = find_gap(session, gates=False, modes=False)
    except ArmodalError as problem:
        return {
            "number": spec.number,
            "error": str(problem),
            "truth_sha256": case.truth_sha256,
            "arm": spec.arm,
        }
    spent = process_time() - begin
    result = outcome.result
    truth = json.loads(case.open_truth())
    marked = mark(truth, result)
    believed = {j.name: j.stiffness.value for j in case.arm.joints if j.stiffness is not None}
    return {
        "number": spec.number,
        "arm": spec.arm,
        "kinds": list(spec.kinds),
        "magnitude": spec.magnitude,
        "truth_sha256": case.truth_sha256,
        "verdict": result.verdict.value,
        **asdict(marked),
        "true_verdict": truth["verdict"],
        "misfit": result.misfit_per_line,
        "cpu_s": spent,
        "sizes": _sizes(truth, result.effects, believed),
        "stiffness": [
            {
                "joint": row.joint,
                "k": row.k_n_m_per_rad,
                "std": row.k_std,
                "low": row.low,
                "high": row.high,
                "true": truth["joints"][row.joint]["stiffness_n_m_per_rad"],
            }
            for row in result.joint_stiffness_ranges
            if row.joint in truth["joints"]
        ],
        "gap": [
            [before.frf_error, after.frf_error, after.floor, after.held_out]
            for before, after in zip(result.gap_before, result.gap_after, strict=True)
        ],
        "best_gain": max((r.gain for r in result.rivals), default=0.0),
    }


def _sizes(truth: Line, effects: Iterable[Any], believed: dict[str, float]) -> list[Line]:
    rows = []
    for true in truth["effects"]:
        value = size_of_truth(true, believed)
        ours = next((e for e in effects if e.name == true["name"] and e.size), None)
        if value is None or ours is None:
            continue
        found, low, high = size_found(ours)
        rows.append({"name": true["name"], "true": value, "found": found, "low": low, "high": high})
    return rows


def run_study(
    specs: Sequence[CaseSpec],
    path: Path,
    executor: Executor,
    tell: Callable[[Line], None] = lambda _: None,
) -> list[Line]:
    """Run what is not yet in the study's file, in parallel; every finished case is kept.

    Parameters
    ----------
    path
        JSON lines; made if it is not there.
    executor
        Any executor whose workers can import this project.
    """
    done: dict[int, Line] = {}
    hashes = seal_hashes(specs)
    if path.exists():
        for text in path.read_text().splitlines():
            line = json.loads(text)
            if hashes.get(line.get("number")) == line.get("truth_sha256"):
                done[line["number"]] = line
    waiting = [spec for spec in specs if spec.number not in done]
    with path.open("a") as file:
        futures = [executor.submit(run_case, spec) for spec in waiting]
        for future in as_completed(futures):
            line = future.result()
            file.write(json.dumps(line) + "\n")
            file.flush()
            os.fsync(file.fileno())
            done[line["number"]] = line
            tell(line)
    return [done[spec.number] for spec in specs if spec.number in done]


def study_summary(lines: Sequence[Line]) -> dict[str, Any]:
    """Counts, rates with their intervals, errors and coverage."""
    judged = [line for line in lines if "error" not in line]
    nulls = [x for x in judged if x["magnitude"] == "none"]
    single = [x for x in judged if len(x["true"]) == 1 and x["true_verdict"] == "named"]
    pairs = [x for x in judged if len(x["true"]) == 2]
    outside = [x for x in judged if x["true_verdict"] == "outside_library"]
    groups: dict[str, list[Line]] = {"nulls": nulls}
    for size in ("clear", "medium", "faint"):
        groups[size] = [x for x in single if x["magnitude"] == size]
    groups |= {"two at once": pairs, "outside": outside}
    table = {
        name: {
            "n": len(group),
            "right": asdict(rate(_count(group, "right"), len(group))) if group else None,
            "wrong": asdict(rate(_count(group, "wrong name"), len(group))) if group else None,
            **{outcome: _count(group, outcome) for outcome in OUTCOMES},
        }
        for name, group in groups.items()
    }
    errors, covered = _size_errors(judged)
    k_errors, k_covered = _stiffness_errors([*nulls, *single])
    held = [g[1] / g[2] for x in judged for g in x["gap"] if g[3]]
    return {
        "groups": table,
        "confusion": _confusion(single),
        "size_error_median": _median(errors),
        "size_covered": covered,
        "k_error_median": _median(k_errors),
        "k_covered": k_covered,
        "held_out_error_over_floor_median": _median(held),
        "cpu_s_median": _median([x["cpu_s"] for x in judged]),
        "cpu_s_most": max((x["cpu_s"] for x in judged), default=float("nan")),
        "failed": [x["number"] for x in lines if "error" in x],
    }


def _count(group: Sequence[Line], outcome: str) -> int:
    return sum(x["outcome"] == outcome for x in group)


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else float("nan")


def _size_errors(lines: Sequence[Line]) -> tuple[list[float], dict[str, float]]:
    rows = [row for x in lines if x["outcome"] == "right" for row in x["sizes"]]
    errors = [abs(row["found"] / row["true"] - 1.0) for row in rows]
    inside = sum(row["low"] <= row["true"] <= row["high"] for row in rows)
    return errors, asdict(rate(inside, len(rows))) if rows else {}


def _stiffness_errors(lines: Sequence[Line]) -> tuple[list[float], dict[str, float]]:
    rows = [row for x in lines for row in x["stiffness"]]
    errors = [abs(row["k"] / row["true"] - 1.0) for row in rows]
    inside = sum(row["low"] <= row["true"] <= row["high"] for row in rows)
    return errors, asdict(rate(inside, len(rows))) if rows else {}


def _confusion(lines: Sequence[Line]) -> dict[str, dict[str, int]]:
    """Truth by what was said."""
    table: dict[str, dict[str, int]] = {}
    for x in lines:
        said = " + ".join(x["named"]) or x["verdict"]
        row = table.setdefault(x["true"][0], {})
        row[said] = row.get(said, 0) + 1
    return table


def study_tables(summary: dict[str, Any]) -> list[Table]:
    """The summary for people."""
    table = Table("cases", "n", "right", "95 %", *OUTCOMES[1:], title="Verdicts")
    for name, row in summary["groups"].items():
        right = row["right"]
        table.add_row(
            name,
            str(row["n"]),
            str(row["right"]["k"]) if right else "-",
            f"{100 * right['low']:.0f}-{100 * right['high']:.0f} %" if right else "-",
            *(str(row[outcome]) for outcome in OUTCOMES[1:]),
        )
    confusion = Table("truth", "said", title="Confusion of single effects")
    for name, said in sorted(summary["confusion"].items()):
        confusion.add_row(name, ", ".join(f"{what} {n}" for what, n in said.items()))
    figures = Table("figure", "value", title="Figures")
    figures.add_row("size of a named effect, median error", _percent(summary["size_error_median"]))
    figures.add_row("its 95 % interval covers", _covered(summary["size_covered"]))
    figures.add_row("joint stiffness, median error", _percent(summary["k_error_median"]))
    figures.add_row("its range covers", _covered(summary["k_covered"]))
    ratio = summary["held_out_error_over_floor_median"]
    figures.add_row("held-out FRF error over the floor, median", f"{ratio:.2f}")
    spent = f"{summary['cpu_s_median']:.1f} s, at most {summary['cpu_s_most']:.1f} s"
    figures.add_row("time a case on one core", spent)
    return [table, confusion, figures]


def _percent(value: float) -> str:
    return f"{100 * value:.2f} %"


def _covered(found: dict[str, float]) -> str:
    return f"{found['k']} of {found['n']}" if found else "-"
