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
    against ours that the first test brought, and that random ones did.
    """
    laboratory = SimulatedLaboratory(case=case)
    arm, sessions = case.arm, [session]
    rows: list[Line] = []
    brought: Line = {}
    while len(rows) < most and _asks(outcome.result):
        advice = outcome.result.next_test
        if advice is None:
            break
        plan = plan_from_text(advice.plan_toml, arm, origin="proposed plan")
        sessions.append(laboratory.measure(plan, len(sessions) + 1))
        if whole is not None and not rows:
            brought = _brought(laboratory, sessions, outcome, whole)
        outcome = find_gap(sessions[0], more=sessions[1:], gates=False, modes=False)
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
    return {"after": rows, "brought": brought}


def _asks(result: GapResult) -> bool:
    return result.verdict in (Verdict.AMBIGUOUS, Verdict.NOTHING_DETECTABLE)


def _brought(
    laboratory: SimulatedLaboratory, sessions: list[Session], outcome: GapOutcome, whole: Fit
) -> Line:
    """Evidence for the true model against ours of the asked test and of random ones."""
    stage, plan = outcome.stages[-1], sessions[0].header.plan
    true_keys = {i.key for i in whole.hypothesis.instances}
    others = [f for f in outcome.standing if {i.key for i in f.hypothesis.instances} != true_keys]
    other = others[0] if others else outcome.final
    rng = np.random.default_rng(_SEED)
    tests = possible_tests(stage, outcome.final, rng=rng)
    random = []
    for i in rng.choice(len(tests), min(_RANDOM, len(tests)), replace=False):
        text = plan_text(tests[i], plan, laboratory.arm, comment="random")
        drawn = plan_from_text(text, laboratory.arm, origin="random plan")
        measured = laboratory.measure(drawn, 100 + int(i))
        random.append(_evidence(outcome.stages, sessions[0], measured, whole, other))
    asked = _evidence(outcome.stages, sessions[0], sessions[-1], whole, other)
    return {"asked": asked, "random": random}


def _evidence(
    stages: tuple[Stage, ...], session: Session, test: Session, whole: Fit, other: Fit
) -> float:
    """Of soft and hard hits apart where the session's were."""
    ordinary = whole.hypothesis.ordinary
    about = middle_level(session) if ordinary.level_span else None
    tested = with_test(stages, ordinary.superset, test, 2, level_about=about)[-1]
    return evidence_brought(whole, other, tested)
