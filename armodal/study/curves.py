"""Learning curves: what each further posture, point and hit buys.

Cases of a study are measured again with less, and judged.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from pathlib import Path

import numpy as np

from armodal.analyzer.gap.workflow import find_gap
from armodal.hil_sim.study import CaseSpec, sealed
from armodal.hil_sim.study.arms import study_arm
from armodal.protocols.errors import ArmodalError
from armodal.protocols.plan_records import Plan
from armodal.study.kept_lines import Line, kept_lines, run_and_keep
from armodal.study.score import mark

__all__ = ["VARIED", "curve_rows", "levels_of", "reduced", "run_curves"]

VARIED: dict[str, tuple[int, ...]] = {
    "postures": (2, 3, 4, 5),
    "points": (4, 6, 9, 18),
    "hits": (1, 2, 3),
}


def reduced(plan: Plan, varied: str, n: int) -> Plan:
    """Return a plan with n postures, points or hits a point; one posture is kept for validation.

    Points are taken evenly from the plan's order.
    """
    if varied == "hits":
        return replace(plan, hits_per_point=n)
    if varied == "postures":
        fitted = [p for p in plan.postures if not p.validation]
        kept = [p for p in plan.postures if p.validation]
        kept = kept[: max(1, n - len(fitted))]
        return replace(plan, postures=(*fitted[: n - len(kept)], *kept))
    points = plan.postures[0].points
    chosen = {points[round(i)] for i in np.linspace(0, len(points) - 1, n)}
    return replace(
        plan,
        postures=tuple(
            replace(posture, points=tuple(p for p in posture.points if p in chosen))
            for posture in plan.postures
        ),
    )


def levels_of(spec: CaseSpec, varied: str, n: int) -> tuple[float, ...] | None:
    """Return the peaks of n hits of a ladder, from its middle outward; None: as planned."""
    if varied != "hits" or not spec.ladder:
        return None
    ladder = study_arm(spec.arm).ladder_n
    return {1: ladder[1:2], 2: (ladder[0], ladder[-1])}.get(n, ladder)


def run_curves(
    specs: Sequence[CaseSpec],
    hashes: Mapping[int, str],
    path: Path,
    executor: Executor,
    tell: Callable[[str], None] = lambda _: None,
) -> list[Line]:
    """Judge every case with every reduced plan; what is in the file already is not run again.

    Parameters
    ----------
    hashes
        Of the truths, by number: a line of another truth, or that tells none, does not count.

    Raises
    ------
    SessionError
        If the file is not one of curves.
    """
    done: dict[tuple[int, str, int], Line] = {
        (line["number"], line["varied"], line["n"]): line
        for line in kept_lines(path, "number", "varied", "n", tell=tell)
        if "truth_sha256" in line and line["truth_sha256"] == hashes.get(line["number"])
    }
    wanted = [(spec, varied, n) for spec in specs for varied, ns in VARIED.items() for n in ns]
    waiting = [job for job in wanted if (job[0].number, job[1], job[2]) not in done]

    def keep(line: Line) -> None:
        done[line["number"], line["varied"], line["n"]] = line
        tell(f"case {line['number']}, {line['n']} {line['varied']}: {line['outcome']}")

    run_and_keep(path, executor, _judged, waiting, keep)
    return [done[spec.number, varied, n] for spec, varied, n in wanted]


def _judged(spec: CaseSpec, varied: str, n: int) -> Line:
    case = sealed(spec)
    line: Line = {
        "number": spec.number,
        "seed": spec.seed,
        "truth_sha256": case.truth_sha256,
        "varied": varied,
        "n": n,
    }
    try:
        session = case.session(reduced(case.plan, varied, n), levels_n=levels_of(spec, varied, n))
        result = find_gap(session, gates=False, modes=False, advice=False).result
    except ArmodalError as problem:
        return line | {"outcome": "refused", "why": str(problem)}
    truth = json.loads(case.open_truth())
    widths = [np.log(r.high / r.low) / 2.0 for r in result.joint_stiffness_ranges]
    sizes = [e.parameters[e.size] for e in result.effects if e.size]
    stds = [abs(s.std / s.value) for s in sizes if s.value]  # at its bound a size may rest at 0
    return line | {
        "outcome": mark(truth, result).outcome,
        "k_range": float(np.median(widths)),
        "size_std": float(np.median(stds)) if stds else None,
        "gain": max((e.gain for e in result.effects), default=0.0),
    }


def curve_rows(lines: Sequence[Line]) -> list[Line]:
    """Return, for each number of what was varied, how many were right and how sure."""
    rows = []
    for varied, ns in VARIED.items():
        for n in ns:
            group = [x for x in lines if (x["varied"], x["n"]) == (varied, n)]
            judged = [x for x in group if "k_range" in x]
            stds = [x["size_std"] for x in judged if x["size_std"] is not None]
            rows.append(
                {
                    "varied": varied,
                    "n": n,
                    "cases": len(group),
                    "right": sum(x["outcome"] == "right" for x in group),
                    "wrong": sum(x["outcome"] == "wrong name" for x in group),
                    "size_std": float(np.median(stds)) if stds else None,
                    "k_range": float(np.median([x["k_range"] for x in judged])) if judged else None,
                    "gain": float(np.median([x["gain"] for x in judged])) if judged else None,
                }
            )
    return rows
