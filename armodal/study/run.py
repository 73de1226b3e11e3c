"""Sealed cases through the gap workflow, each marked against its truth.

The hashes of all truths are told before the first verdict. A finished case is a line of the
study's file, so that a study that was stopped goes on where it was.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from armodal.analyzer.gap.inference.compare import posture_gap
from armodal.analyzer.gap.inference.fit import Fit, Stage, fit_hypothesis
from armodal.analyzer.gap.inference.held_out import held_out
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.workflow import GapOutcome, find_gap
from armodal.hil_sim.study.true_effects import ordinary_beside, size_of_truth
from armodal.protocols.errors import ArmodalError
from armodal.study.cases import AnySpec, case_of
from armodal.study.further_tests import further
from armodal.study.kept_lines import Line, kept_lines, run_and_keep
from armodal.study.pace import pace
from armodal.study.score import instance_of_truth, mark, size_found

__all__ = ["run_case", "run_study", "seal_hashes"]

_ALSO = 5  # of the cases that hide nothing each fifth asks for further tests too
_STEPS = 20  # at each stage: from the true sizes a fit converges within these


def seal_hashes(specs: Sequence[AnySpec], executor: Executor) -> dict[int, str]:
    """Return the hash of every case's truth, by number."""
    hashes = executor.map(_hash_of, specs)
    return {spec.number: digest for spec, digest in zip(specs, hashes, strict=True)}


def _hash_of(spec: AnySpec) -> str:
    return case_of(spec).truth_sha256


def run_case(spec: AnySpec, tests: int = 0) -> Line:
    """Make a case, judge it, open its truth, mark it.

    Parameters
    ----------
    tests
        Further ones, at most, that the workflow may ask for while nothing is named.
    """
    case = case_of(spec)
    session = case.session()
    paces = [pace()]
    begin = process_time()
    try:
        outcome = find_gap(session, gates=False, modes=False, advice=tests > 0)
    except ArmodalError as problem:
        return {
            "number": spec.number,
            "error": str(problem),
            "truth_sha256": case.truth_sha256,
            "arm": spec.arm,
            "tests": tests,
        }
    spent = process_time() - begin
    paces.append(pace())
    result = outcome.result
    truth = json.loads(case.open_truth())
    marked = mark(truth, result)
    believed = {j.name: j.stiffness.value for j in case.arm.joints if j.stiffness is not None}
    final = outcome.final.hypothesis
    hypothesis = _true_hypothesis(truth, final.ordinary)
    whole = None
    if hypothesis is not None and {i.key for i in hypothesis.instances} != {
        i.key for i in final.instances
    }:
        whole = _fitted_from_truth(truth, hypothesis, outcome.stages, believed)
    after: Line = {}
    if tests:
        try:
            after = further(case, session, outcome, truth, most=tests)
        except ArmodalError as problem:
            after = {"refused_test": str(problem)}
    return {
        "number": spec.number,
        "arm": spec.arm,
        "kinds": list(spec.kinds),
        "magnitude": spec.magnitude,
        "truth_sha256": case.truth_sha256,
        "tests": tests,
        "verdict": result.verdict.value,
        **asdict(marked),
        "true_verdict": truth["verdict"],
        "misfit": result.misfit_per_line,
        "replicas_leave": None if result.misfit is None else result.misfit.replicas_leave,
        "confidence": result.confidence,
        "false_name_probability": result.false_name_probability,
        "cpu_s": spent,
        "pace": sum(paces) / len(paces),
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
        "rivals": [[r.name, r.place, r.gain] for r in result.rivals],
        **_beside_true_model(outcome, hypothesis, whole, _seen(truth)),
        **after,
    }


def _beside_true_model(
    outcome: GapOutcome, hypothesis: Hypothesis | None, whole: Fit | None, seen: float | None
) -> dict[str, float | None]:
    """Held-out FRF error of our model, and of that without any effect, over the true model's.

    None where the library has no true model; a true model that was not fitted is ours. `seen` is
    how far the effect stands out by its maker, where it tells.
    """
    if hypothesis is None:
        return {"over_true_model": None, "stands_out": seen}
    after = outcome.result.gap_after
    test = [p for p, gap in enumerate(after) if gap.held_out]
    ours = np.linalg.norm([after[p].frf_error for p in test])
    reached = ours
    if whole is not None:
        right = held_out(outcome.stages[-1], whole, test).training
        gaps = [posture_gap(outcome.stages[-1], right, p, held_out=True).frf_error for p in test]
        reached = np.linalg.norm(gaps)
    without = np.linalg.norm([outcome.result.gap_before[p].frf_error for p in test])
    return {"over_true_model": float(ours / reached), "stands_out": float(without / reached)}


def _seen(truth: Line) -> float | None:
    """How far what is hidden stands out of the ordinary; None where its maker does not say."""
    told = [e[key] for e in truth["effects"] for key in ("visible", "stands_out") if key in e]
    return float(min(told)) if told else None


def _true_hypothesis(truth: Line, ordinary: Ordinary) -> Hypothesis | None:
    """The true effects at their true places; None where the library has no such model.

    Other makers have none: their bodies are not the library's.
    """
    if "plant" not in truth:
        return None
    instances = [instance_of_truth(ordinary, effect) for effect in truth["effects"]]
    known = [i for i in instances if i is not None]
    if len(known) < len(instances):
        return None
    return Hypothesis(ordinary=ordinary, instances=tuple(known))


def _fitted_from_truth(
    truth: Line, hypothesis: Hypothesis, stages: Sequence[Stage], believed: dict[str, float]
) -> Fit:
    """The true model with the same nuisances as ours, from its true sizes."""
    sizes = {
        instance.size: size_of_truth(effect, believed)
        for instance, effect in zip(hypothesis.instances, truth["effects"], strict=True)
    }
    start = {name: size for name, size in sizes.items() if name and size is not None}
    fit = fit_hypothesis(stages[0], hypothesis, start=start, max_iterations=_STEPS)
    for stage in stages[1:]:
        fit = fit_hypothesis(stage, hypothesis, start=fit.values, max_iterations=_STEPS)
    return fit


def _sizes(truth: Line, effects: Iterable[Any], believed: dict[str, float]) -> list[Line]:
    rows = []
    for true in truth["effects"]:
        ours = next((e for e in effects if e.name == true["name"] and e.size), None)
        if ours is None:
            continue
        value = size_of_truth(true, believed, ours.description)
        if value is None:
            continue
        found, low, high = size_found(ours)
        value += ordinary_beside(true, truth)
        rows.append({"name": true["name"], "true": value, "found": found, "low": low, "high": high})
    return rows


def run_study(
    specs: Sequence[AnySpec],
    hashes: Mapping[int, str],
    path: Path,
    executor: Executor,
    tell: Callable[[str], None] = lambda _: None,
    *,
    tests: int = 0,
) -> list[Line]:
    """Run what is not yet in the study's file, in parallel; every finished case is kept.

    Parameters
    ----------
    hashes
        Of the truths, by number, told before: a line of another truth does not count.
    path
        JSON lines; made if it is not there.
    executor
        Any executor whose workers can import this project, Dask's too (`bench/study_on_dask.py`).
    tests
        Further ones that a case may have: every case that hides something, and of those that hide
        nothing each fifth. A line that was judged with another number of them does not count.

    Raises
    ------
    SessionError
        If the file is not one of a study.
    """
    allowed = {s.number: tests if s.kinds or not s.number % _ALSO else 0 for s in specs}
    done: dict[int, Line] = {
        line["number"]: line
        for line in kept_lines(path, "number", "truth_sha256", tell=tell)
        if hashes.get(line["number"]) == line["truth_sha256"]
        and line.get("tests") == allowed.get(line["number"])
    }
    waiting = [(s, allowed[s.number]) for s in specs if s.number not in done]

    def keep(line: Line) -> None:
        done[line["number"]] = line
        tell(f"case {line['number']}: {line.get('outcome', line.get('error'))}")

    run_and_keep(path, executor, run_case, waiting, keep)
    return [done[spec.number] for spec in specs if spec.number in done]
