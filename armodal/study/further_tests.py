"""What further tests bring to a case: those the workflow asks for, and random ones beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.inference.annealing import with_test
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.hit_levels import middle_level
from armodal.analyzer.gap.model.weigh import Discrepancy
from armodal.analyzer.gap.next_test.advice import NARROWS, plan_text
from armodal.analyzer.gap.next_test.possible_tests import possible_tests
from armodal.analyzer.gap.next_test.proposal import evidence_brought
from armodal.analyzer.gap.records import GapResult, Verdict
from armodal.analyzer.gap.search.levels import any_level, weighed_anew
from armodal.analyzer.gap.workflow import GapOutcome, find_gap
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.records import Session
from armodal.study.cases import AnyCase
from armodal.study.kept_lines import Line
from armodal.study.laboratory import SimulatedLaboratory
from armodal.study.score import instance_of_truth, mark

__all__ = ["further", "nearer_first"]

_RANDOM = 3  # random tests beside each that was asked for
_SEED = 31


def further(
    case: AnyCase,
    session: Session,
    outcome: GapOutcome,
    truth: Line,
    *,
    most: int,
) -> Line:
    """Measure what the workflow asks for while nothing is named, and judge again.

    Parameters
    ----------
    outcome
        Of the first session, with advice.

    Returns
    -------
    `after`: verdict, mark and names after each test; `brought`: evidence in nats that the first
    test, and random ones, brought for the one nearer to the truth of the models it was to tell
    apart; `widths`: of the ranges of joint stiffness before it, after it, and after the first
    random one instead.
    """
    laboratory = SimulatedLaboratory(case=case)
    arm, sessions = case.arm, [session]
    rows: list[Line] = []
    brought: Line = {}
    widths: Line = {}
    while len(rows) < most and _asks(outcome.result):
        advice = outcome.result.next_test
        if advice is None:
            break
        plan = plan_from_text(advice.plan_toml, arm, origin="proposed plan")
        sessions.append(laboratory.measure(plan, len(sessions) + 1))
        before = outcome
        outcome = find_gap(sessions[0], more=sessions[1:], gates=False, modes=False)
        if not rows:
            random = _random_tests(laboratory, sessions[0], before)
            other = find_gap(sessions[0], more=random[:1], gates=False, modes=False, advice=False)
            brought = _brought(sessions, random, before, truth)
            widths = {
                "before": _width(before.result),
                "asked": _width(outcome.result),
                "random": _width(other.result),
            }
        marked = mark(truth, outcome.result)
        rows.append(
            {
                "words": advice.words,
                "why": advice.why,
                "expected": advice.gain,
                "verdict": outcome.result.verdict.value,
                "outcome": marked.outcome,
                "named": list(marked.named),
            }
        )
    return {"after": rows, "brought": brought, "widths": widths}


def _asks(result: GapResult) -> bool:
    return result.verdict in (Verdict.AMBIGUOUS, Verdict.NOTHING_DETECTABLE)


def _width(result: GapResult) -> float:
    """Mean half width of ln k of the joints' ranges."""
    ranges = result.joint_stiffness_ranges
    return float(np.mean([np.log(r.high / r.low) / 2.0 for r in ranges]))


def _random_tests(
    laboratory: SimulatedLaboratory, session: Session, outcome: GapOutcome
) -> list[Session]:
    """Measured tests out of those that the search for the proposed one begins with."""
    rng = np.random.default_rng(_SEED)
    tests = possible_tests(outcome.stages[-1], outcome.final, rng=rng)
    measured = []
    for i in rng.choice(len(tests), min(_RANDOM, len(tests)), replace=False):
        text = plan_text(tests[i], session.header.plan, laboratory.arm, comment="random")
        plan = plan_from_text(text, laboratory.arm, origin="random plan")
        measured.append(laboratory.measure(plan, 100 + int(i)))
    return measured


def _brought(
    sessions: list[Session], random: list[Session], outcome: GapOutcome, truth: Line
) -> Line:
    """Evidence of the asked test and of random ones for the nearer to the truth.

    Nothing where the test was to narrow a range, or none of the models is near.
    """
    advice = outcome.result.next_test
    if advice is None or NARROWS in advice.why:
        return {}
    ordinary = outcome.final.hypothesis.ordinary
    instances = [instance_of_truth(ordinary, effect) for effect in truth["effects"]]
    pair = nearer_first(outcome.compared, [None if i is None else i.key for i in instances])
    if pair is None:
        return {}
    first, asked = sessions[0], sessions[-1]
    brought = [_evidence(outcome.stages, first, test, *pair) for test in (asked, *random)]
    return {"asked": brought[0], "random": brought[1:]}


def nearer_first(
    compared: Sequence[Fit], truth: Sequence[tuple[str, str] | None]
) -> tuple[Fit, Fit] | None:
    """Of models that were compared the nearest to the truth, and the best of the others.

    The nearest holds nothing that is not true, and of that the most.

    Parameters
    ----------
    truth
        Effect and place of all that is true; None for what the library has no model of: nothing
        is near it.
    """
    if None in truth:
        return None
    keys = [{i.key for i in fit.hypothesis.instances} for fit in compared]
    true = [n for n, own in enumerate(keys) if own <= set(truth)]
    if not true or len(compared) < 2:
        return None
    best = max(true, key=lambda n: len(keys[n]))
    other = next(n for n in range(len(compared)) if n != best)
    return compared[best], compared[other]


def _evidence(
    stages: tuple[Stage, ...], session: Session, test: Session, nearer: Fit, other: Fit
) -> float:
    """Of soft and hard hits apart where the session's were, and weighed as those."""
    ordinary = nearer.hypothesis.ordinary
    superset, sharp = ordinary.superset, stages[-1]
    about = middle_level(session) if ordinary.level_span else None
    tested = with_test(stages, superset, test, 2, level_about=about)
    lines = tested[-1].lines
    if about is not None:
        postures = tuple(dict.fromkeys(own.name for own in lines))
        present = replace(nearer.hypothesis, ordinary=replace(ordinary, postures=postures))
        free = any_level(tested[-2], present, nearer.values)
        lines = (*sharp.lines, *weighed_anew(tested[-1], free)[len(sharp.lines) :])
    stage = Stage(superset, lines, Discrepancy(), models=tested[-1].models)
    return evidence_brought(nearer, other, stage)
