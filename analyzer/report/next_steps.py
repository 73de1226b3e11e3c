"""What to do next, most urgent first."""

from __future__ import annotations

from collections.abc import Sequence

from armodal.analyzer.gap.records import GapResult, Verdict
from armodal.analyzer.report.check_rows import CheckRow
from armodal.protocols.session.records import Session

__all__ = ["next_steps"]

_MOST_TESTS = 2  # of rivals, on a page that is read in a minute


def next_steps(
    session: Session, checks: Sequence[CheckRow], gap: GapResult | None
) -> tuple[str, ...]:
    """Return a few sentences; the last resort is that nothing is left to do."""
    steps = [
        f"Correct a fault of the measurement, {row.check}: {row.text}. Then measure again."
        for row in checks
        if row.state == "fault"
    ]
    if not session.complete:
        steps.append("Measure the points that are missing: armodal run takes the session up again.")
    if gap is None:
        steps.append("Ask what the model lacks: armodal gap SESSION. Then make this report again.")
        return tuple(steps)
    steps += [
        f"At {effect.place or 'the arm'}: {effect.remedy}."
        for effect in gap.effects
        if effect.remedy
    ]
    if gap.verdict is Verdict.AMBIGUOUS and gap.next_test is None:
        told = dict.fromkeys(r.told_by for r in gap.rivals if r.standing and r.told_by)
        steps += [
            f"To tell the remaining explanations apart: {test}."
            for test in list(told)[:_MOST_TESTS]
        ]
    if gap.verdict is Verdict.OUTSIDE_LIBRARY:
        steps.append("Look at the point that the finding above names.")
    if gap.next_test is not None:
        test = gap.next_test
        steps.append(f"Next test: {test.words}. It {test.why}.")
    if gap.verdict is Verdict.NAMED:
        steps.append(
            "Use the new arm file: armodal predict --arm computes with what was found of the arm."
        )
    return tuple(steps) or (
        "Nothing: with k, c and tolerances refitted the model explains what this test could see.",
    )
