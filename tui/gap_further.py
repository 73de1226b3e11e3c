"""What further tests bring to a case: those the workflow asks for, and random ones beside them."""

from __future__ import annotations

from typing import Any

import numpy as np

from analyzer.gap.advice import plan_text
from analyzer.gap.fit import Fit, Stage
from analyzer.gap.hit_levels import middle_level
from analyzer.gap.next_test import evidence_brought, possible_tests
from analyzer.gap.records import GapResult, Verdict
from analyzer.gap.score import mark
from analyzer.gap.stages import with_test
from analyzer.gap.workflow import GapOutcome, find_gap
from hil_sim.study import SealedCase
from protocols.plan import plan_from_text
from protocols.session.records import Session
from tui.gap_lab import SimulatedLaboratory

__all__ = ["further"]

Line = dict[str, Any]

_RANDOM = 3  # random tests beside each that was asked for
_SEED = 31


def further(
    case: SealedCase,
    session: Session,
    outcome: GapOutcome,
    truth: Line,
    whole: Fit | None,
    *,
    most: int,
) -> Line:
    """Measure what the workflow asks for while nothing is named, and judge again.

    Parameters
    ----------
    outcome
        Of the first session, with advice.
    whole
        The true model fitted to the first session, where ours is another.

    Returns
    -------
    `after`: verdict, mark and names after each test; `brought`: evidence in nats for the true model
    against ours that the first test brought, and that random ones did; `widths`: of the ranges of
    joint stiffness before it, after it, and after the first random one instead.
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
            if whole is not None:
                brought = _brought(sessions, random, before, whole)
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
    """Measured tests out of those that the proposed one was chosen from."""
    rng = np.random.default_rng(_SEED)
    tests = possible_tests(outcome.stages[-1], outcome.final, rng=rng)
    measured = []
    for i in rng.choice(len(tests), min(_RANDOM, len(tests)), replace=False):
        text = plan_text(tests[i], session.header.plan, laboratory.arm, comment="random")
        plan = plan_from_text(text, laboratory.arm, origin="random plan")
        measured.append(laboratory.measure(plan, 100 + int(i)))
    return measured


def _brought(
    sessions: list[Session], random: list[Session], outcome: GapOutcome, whole: Fit
) -> Line:
    """Evidence for the true model against ours of the asked test and of random ones."""
    true_keys = {i.key for i in whole.hypothesis.instances}
    others = [f for f in outcome.standing if {i.key for i in f.hypothesis.instances} != true_keys]
    other = others[0] if others else outcome.final
    first, asked = sessions[0], sessions[-1]
    brought = [_evidence(outcome.stages, first, test, whole, other) for test in (asked, *random)]
    return {"asked": brought[0], "random": brought[1:]}


def _evidence(
    stages: tuple[Stage, ...], session: Session, test: Session, whole: Fit, other: Fit
) -> float:
    """Of soft and hard hits apart where the session's were."""
    ordinary = whole.hypothesis.ordinary
    about = middle_level(session) if ordinary.level_span else None
    tested = with_test(stages, ordinary.superset, test, 2, level_about=about)[-1]
    return evidence_brought(whole, other, tested)
