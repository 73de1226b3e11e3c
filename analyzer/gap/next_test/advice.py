"""The proposed next test as a plan: what it tells apart, and how much."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from armodal.analyzer.gap.decision.without_levels import is_alike, titles
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.next_test.at_levels import hits_at_levels
from armodal.analyzer.gap.next_test.possible_tests import Test
from armodal.analyzer.gap.next_test.proposal import hidden_rival, proposed
from armodal.analyzer.gap.records import NextTest
from armodal.analyzer.gap.search.scan import Candidate
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlanError
from armodal.protocols.plan_records import Plan, PlannedPosture
from armodal.protocols.plan_rewrite import text_with_posture

__all__ = ["NARROWS", "Advice", "advise", "at_levels", "plan_text"]

NARROWS = "to narrow the range of k of"  # in the reason of a test that narrows a range

_SEED = 2718  # proposals are repeatable
_MOST_RIVALS = 3
_WIDE = 0.05  # of ln k: a hidden effect that moves a stiffness so far is worth a test
_MUCH = 1000  # to one: how much more does not matter
_WEAK = 20.0  # of evidence: the best rival may be there, and is worth a test
_WORTH = 3.0  # nats: less is not worth an hour in the lab


@dataclass(frozen=True, slots=True, kw_only=True)
class Advice:
    """The next test and the models it is to tell apart; or why there is none."""

    test: NextTest | None = None
    compared: tuple[Fit, ...] = ()
    why_none: str = ""  # where several models stand, or the test cannot be written as a plan


def advise(
    stage: Stage,
    final: Fit,
    standing: Sequence[Fit],
    rivals: Sequence[Fit],
    hiding: Sequence[Candidate],
    changes: Callable[[Candidate], tuple[float, ...]],
    plan: Plan,
    tell: Callable[[str], None],
) -> Advice:
    """Propose what tells rivals apart, whether a weak one is there, or what narrows a stiffness.

    Parameters
    ----------
    standing, rivals
        Those that stand, and all of the last step, best first.
    changes
        By how much a hidden effect's size could differ from what the final model has of it.

    Returns
    -------
    No test where none of the laboratory's would tell enough, or no plan can be written of it.
    """
    if any(is_alike(fit) for fit in standing) or _asks_for_hits_between(standing):
        return at_levels(stage, final, standing, plan)
    rng = np.random.default_rng(_SEED)
    weak = _weak(final, rivals)
    if len(standing) > 1:
        compared = list(standing[:_MOST_RIVALS])
        why = f"tells apart: {titles(compared)}"
    elif weak is not None:
        compared = [final, weak]
        why = f"shows whether “{weak.title}” applies: little speaks for it so far"
    else:
        found = _widest(final, hiding, changes)
        if found is None:
            return Advice()
        candidate, change, joint = found
        compared = [final, hidden_rival(stage, final, candidate, change)]
        why = f"shows whether “{candidate.instance.title}” applies too, {NARROWS} {joint}"
    best = proposed(stage, compared, rng=rng, tell=tell)
    if best is None:
        return Advice()
    test, gain = best
    if gain < _WORTH:
        alike = titles(standing[:_MOST_RIVALS]) if standing else ""
        words = f"no further test here is expected to tell apart: {alike}"
        return Advice(why_none=words if len(standing) > 1 else "")
    odds = f"{np.exp(gain):.0f}" if gain < np.log(_MUCH) else f"more than {_MUCH}"
    words = f"{test.words}; expected to decide by odds of {odds} to 1"
    try:
        text = plan_text(test, plan, final.hypothesis.ordinary.arm, comment=f"Proposed: {why}")
    except PlanError as problem:
        return _unwritten(problem)
    test_of_plan = NextTest(words=words, why=why, gain=gain, plan_toml=text)
    return Advice(test=test_of_plan, compared=tuple(compared))


def _asks_for_hits_between(standing: Sequence[Fit]) -> bool:
    """Whether laws of one joint's change with the level stand, and two levels were hit."""
    last = [fit.last for fit in standing if fit.hypothesis.instances]
    of_one_joint = len({one.place for one in last}) == 1
    one_or_two = of_one_joint and all(one.level_dependent for one in last)
    return one_or_two and len(last) > 1 and not standing[0].hypothesis.ordinary.hits_between


def plan_text(test: Test, plan: Plan, arm: Arm, *, comment: str) -> str:
    """Return a test as the text of a plan like the session's; what differs: `text_with_posture`.

    Raises
    ------
    PlanError
        If the test is not possible for the arm, or the session's plan cannot be read again.
    """
    posture = _posture(plan, test)
    return text_with_posture(plan, arm, posture, comment=comment, fixed_point=test.hit_point)


def at_levels(stage: Stage, final: Fit, standing: Sequence[Fit], plan: Plan) -> Advice:
    """Propose the whole plan once more, at several levels (`hits_at_levels`)."""
    try:
        arm = final.hypothesis.ordinary.arm
        return Advice(test=hits_at_levels(stage, arm, standing, plan))
    except PlanError as problem:
        return _unwritten(problem)


def _unwritten(problem: PlanError) -> Advice:
    """No test, so that what was found is not lost with its plan."""
    return Advice(why_none=f"the next test cannot be written as a plan: {problem}")


def _weak(final: Fit, rivals: Sequence[Fit]) -> Fit | None:
    """The best rival that would matter, if some evidence speaks for it."""
    return next(
        (
            fit
            for fit in rivals
            if final.evidence - fit.evidence > _WEAK
            and fit.hypothesis.instances[-1].is_material(fit.values)
        ),
        None,
    )


def _widest(
    final: Fit, hiding: Sequence[Candidate], changes: Callable[[Candidate], tuple[float, ...]]
) -> tuple[Candidate, float, str] | None:
    """The hidden effect that moves a stiffness furthest, by how much it changes, and the joint."""
    found = [
        (abs(candidate.follow.get(f"ln k {joint}", 0.0) * change), number, change, joint)
        for joint in (final.hypothesis.ordinary.arm.joints[i].name for i in _elastic(final))
        for number, candidate in enumerate(hiding)
        for change in changes(candidate)
    ]
    moved, number, change, joint = max(found, default=(0.0, 0, 0.0, ""))
    return (hiding[number], change, joint) if moved > _WIDE else None


def _elastic(final: Fit) -> tuple[int, ...]:
    return final.hypothesis.ordinary.elastic


def _posture(plan: Plan, test: Test) -> PlannedPosture:
    return PlannedPosture(
        name="next test",
        joints_rad=test.joints_rad,
        tolerance_rad=plan.postures[0].tolerance_rad,
        # A point that was planned, but skipped, is asked for once.
        points=tuple(dict.fromkeys((*plan.postures[0].points, *test.more_points))),
        hit_direction=test.hit_direction,
        validation=False,
        brakes=test.brakes,
        known_mass=test.known_mass,
        peaks_n=test.peaks_n or plan.postures[0].peaks_n,
    )
