"""What a study's cases come to: rates with their intervals, errors, coverage, curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from armodal.analyzer.gap.next_test.advice import NARROWS
from armodal.hil_sim.study.catalogue import MAGNITUDES
from armodal.study.kept_lines import Line
from armodal.study.reliability import reliability
from armodal.study.score import OUTCOMES, rate

__all__ = ["study_summary"]

_CLEAR = 3.0  # held-out error of the model without the effect over the true model's
_MAIN_JOINTS = 3


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
    surely = [x for x in groups["clear"] if (x["stands_out"] or 0.0) >= _CLEAR]
    groups["clear, 3 times the true model's error"] = surely
    groups |= {"two at once": pairs, "outside": outside}
    table = {
        name: {
            **{outcome: _count(group, outcome) for outcome in OUTCOMES},
            "n": len(group),
            "right": asdict(rate(_count(group, "right"), len(group))) if group else None,
            "wrong": asdict(rate(_count(group, "wrong name"), len(group))) if group else None,
            "cpu_s": [_median(own := [x["cpu_s"] for x in group]), max(own, default=0.0)],
        }
        for name, group in groups.items()
    }
    errors, covered = _size_errors(judged)
    k_errors, k_covered, range_covers = _stiffness_errors([*nulls, *single])
    right = [x for x in (*nulls, *single) if x["outcome"] == "right"]
    hiding = [x for x in judged if x["magnitude"] != "none"]
    held = [x["over_true_model"] for x in judged if x["over_true_model"] is not None]
    placed = [x["place_right"] for x in judged if x["place_right"] is not None]
    paced = [x["cpu_s"] / x["pace"] for x in judged]  # as a core of the reference's pace
    return {
        "groups": table,
        "confusion": _confusion(single),
        "place": asdict(rate(sum(placed), len(placed))) if placed else None,
        "size_error_median": _median(errors),
        "size_covered": covered,
        "k_error_median": _median(k_errors),
        "k_covered": k_covered,
        "k_covered_where_right": _stiffness_errors(right)[1],
        "k_range_covers": range_covers,
        "main_k": _main_stiffness(right, judged),
        "wrong_of_effects": asdict(rate(_count(hiding, "wrong name"), len(hiding))),
        "held_out_over_true_model_median": _median(held),
        "held_out_over_true_model_worst": max(held, default=float("nan")),
        "gap": _gaps([x for x in (*single, *pairs) if x["outcome"] == "right"]),
        "detection": _detection(nulls, groups),
        "reliability": [asdict(own) for own in reliability(judged)],
        "ambiguous_holds_truth": _ambiguous_sets(judged),
        "cpu_s_effects": [_median(own := [x["cpu_s"] for x in hiding]), max(own, default=0.0)],
        "cpu_s_median": _median([x["cpu_s"] for x in judged]),
        "cpu_s_most": max((x["cpu_s"] for x in judged), default=float("nan")),
        "pace_median": _median([x["pace"] for x in judged]),
        "reference_s_median": _median(paced),
        "reference_s_most": max(paced, default=float("nan")),
        "failed": [x["number"] for x in lines if "error" in x or "refused_test" in x],
        "tests": _tests(judged, groups),
    }


def _tests(lines: Sequence[Line], groups: dict[str, list[Line]]) -> dict[str, Any]:
    """What further tests that the workflow asked for came to, and random ones beside them.

    A case's outcome is that of its last judgement. What the first test gained is counted in what
    it was asked for: evidence for the model nearer to the truth, or a narrower range of a joint's
    stiffness.
    """
    tried = [x for x in lines if "after" in x]
    narrowing = [x for x in tried if x["after"] and NARROWS in x["after"][0]["why"]]
    asked = [x["brought"]["asked"] for x in tried if x["brought"]]
    random = [float(np.mean(x["brought"]["random"])) for x in tried if x["brought"]]
    twice = sum(a > max(2.0 * r, 0.0) for a, r in zip(asked, random, strict=True))

    def last(x: Line) -> str:
        return str(x["after"][-1]["outcome"] if x["after"] else x["outcome"])

    widths = [x["widths"] for x in narrowing]
    found: dict[str, Any] = {
        "n": len(tried),
        "asked": asdict(rate(sum(bool(x["after"]) for x in tried), len(tried))) if tried else {},
        "wrong": sum(last(x) == "wrong name" for x in tried),
        "compared": len(asked),
        "brought_asked": _median(asked),
        "brought_random": _median(random),
        "brought_in_all": [float(np.sum(asked)), float(np.sum(random))],
        "brought_twice": asdict(rate(twice, len(asked))) if asked else {},
        "widths": {
            "n": len(widths),
            **{when: _median([w[when] for w in widths]) for when in ("before", "asked", "random")},
        },
    }
    for size in ("clear", "medium"):
        group = [x for x in groups[size] if "after" in x]
        right = sum(last(x) == "right" for x in group)
        found[size] = asdict(rate(right, len(group))) if group else {}
    return found


def _gaps(lines: Sequence[Line]) -> dict[str, float]:
    """Median held-out FRF error before and after, of effects named right."""
    held = [[row for row in x["gap"] if row[3]] for x in lines]
    return {
        "before": _median([float(np.mean([row[0] for row in rows])) for rows in held]),
        "after": _median([float(np.mean([row[1] for row in rows])) for rows in held]),
    }


def _detection(nulls: Sequence[Line], groups: dict[str, list[Line]]) -> list[dict[str, Any]]:
    """How often anything is said, and the right thing, over the effect's size; clear is 1."""
    rows = []
    for size, group in ((0.0, nulls), *((MAGNITUDES[m], groups[m]) for m in MAGNITUDES)):
        said = sum(x["verdict"] != "nothing_detectable" for x in group)
        if group:
            right = _count(group, "right") if size else 0
            rows.append(
                {
                    "size": size,
                    "n": len(group),
                    "said": asdict(rate(said, len(group))),
                    "right": asdict(rate(right, len(group))),
                }
            )
    return sorted(rows, key=lambda row: float(row["size"]))


def _ambiguous_sets(lines: Sequence[Line]) -> dict[str, Any]:
    """How often an ambiguous verdict's set holds the truth, where the truth is in the library."""
    group = [x for x in lines if x["verdict"] == "ambiguous" and x["true_verdict"] == "named"]
    return asdict(rate(_count(group, "ambiguous with the truth"), len(group))) if group else {}


def _count(group: Sequence[Line], outcome: str) -> int:
    return sum(x["outcome"] == outcome for x in group)


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else float("nan")


def _size_errors(lines: Sequence[Line]) -> tuple[list[float], dict[str, float]]:
    rows = [row for x in lines if x["outcome"] == "right" for row in x["sizes"]]
    errors = [abs(row["found"] / row["true"] - 1.0) for row in rows]
    inside = sum(row["low"] <= row["true"] <= row["high"] for row in rows)
    return errors, asdict(rate(inside, len(rows))) if rows else {}


def _stiffness_errors(
    lines: Sequence[Line],
) -> tuple[list[float], dict[str, float], dict[str, float]]:
    """Errors of the first joints; how often k ± 1.96 std covers, and how often the range does."""
    rows = [row for x in lines for row in x["stiffness"]]
    main = [row for x in lines for row in x["stiffness"][:_MAIN_JOINTS]]
    errors = [abs(row["k"] / row["true"] - 1.0) for row in main]
    inside = sum(row["low"] <= row["true"] <= row["high"] for row in rows)
    if not rows:
        return errors, {}, {}
    return errors, asdict(rate(_within(rows), len(rows))), asdict(rate(inside, len(rows)))


def _within(rows: Sequence[Line]) -> int:
    """Of how many joints k is within 1.96 of its deviations."""
    return sum(abs(np.log(row["k"] / row["true"])) <= 1.96 * row["std"] / row["k"] for row in rows)


def _main_stiffness(right: Sequence[Line], lines: Sequence[Line]) -> dict[str, Any]:
    """Of the first joints: error of nulls and names that are right; intervals of every verdict.

    The interval is k with 1.96 of its deviations either way, the range what all that nobody would
    see leaves of it (`stiffness_ranges`).
    """
    told = [row for x in right for row in x["stiffness"][:_MAIN_JOINTS]]
    rows = [row for x in lines for row in x["stiffness"][:_MAIN_JOINTS]]
    inside = sum(row["low"] <= row["true"] <= row["high"] for row in rows)
    return {
        "error_median": _median([abs(row["k"] / row["true"] - 1.0) for row in told]),
        "interval_covers": asdict(rate(_within(rows), len(rows))),
        "range_covers": asdict(rate(inside, len(rows))),
        "half_width_median": _median([np.log(row["high"] / row["low"]) / 2.0 for row in rows]),
    }


def _confusion(lines: Sequence[Line]) -> dict[str, dict[str, int]]:
    """Truth by what was said."""
    table: dict[str, dict[str, int]] = {}
    for x in lines:
        said = " + ".join(x["named"]) or x["verdict"]
        row = table.setdefault(x["true"][0], {})
        row[said] = row.get(said, 0) + 1
    return table
