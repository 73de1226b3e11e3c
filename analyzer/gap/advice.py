"""The proposed next test as a plan: what it tells apart, and how much."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from analyzer.gap.fit import Fit, Stage
from analyzer.gap.next_test import Test, hidden_rival, proposed
from analyzer.gap.records import NextTest
from analyzer.gap.scan import Candidate
from protocols.arm.records import Arm
from protocols.plan_records import Plan, PlannedPosture
from protocols.plan_rewrite import text_with_posture

__all__ = ["advise", "plan_text"]

_SEED = 2718  # proposals are repeatable
_MOST_RIVALS = 3
_WIDE = 0.05  # of ln k: a hidden effect that moves a stiffness so far is worth a test
_WORTH = 3.0  # nats: less is not worth an hour in the lab


def advise(
    stage: Stage,
    final: Fit,
    standing: Sequence[Fit],
    hiding: Sequence[Candidate],
    changes: Callable[[Candidate], tuple[float, ...]],
    plan: Plan,
    tell: Callable[[str], None],
) -> NextTest | None:
    """Propose what tells standing rivals apart, or what narrows a joint's stiffness.

    Parameters
    ----------
    changes
        By how much a hidden effect's size could differ from what the final model has of it.

    Returns
    -------
    None where no test of the laboratory would tell enough.
    """
    rng = np.random.default_rng(_SEED)
    if len(standing) > 1:
        rivals = list(standing[:_MOST_RIVALS])
        why = f"tells apart: {', or '.join(_title(fit) for fit in rivals)}"
    else:
        found = _widest(final, hiding, changes)
        if found is None:
            return None
        candidate, change, joint = found
        rivals = [final, hidden_rival(stage, final, candidate, change)]
        why = f"shows whether {candidate.instance.title} hides, which widens k of {joint}"
    best = proposed(stage, rivals, rng=rng, tell=tell)
    if best is None or (best[1] < _WORTH and len(standing) < 2):
        return None
    test, gain = best
    words = f"{test.words}; expected evidence {gain:.0f} nats"
    text = plan_text(test, plan, final.hypothesis.ordinary.arm, comment=f"Proposed: {why}")
    return NextTest(words=words, why=why, gain=gain, plan_toml=text)


def plan_text(test: Test, plan: Plan, arm: Arm, *, comment: str) -> str:
    """Return a test as a plan's text, everything else as in the session's plan."""
    return text_with_posture(plan, arm, _posture(plan, test), comment=comment)


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


def _title(fit: Fit) -> str:
    return fit.hypothesis.instances[-1].title if fit.hypothesis.instances else "nothing missing"


def _posture(plan: Plan, test: Test) -> PlannedPosture:
    return PlannedPosture(
        name="next test",
        joints_rad=test.joints_rad,
        tolerance_rad=plan.postures[0].tolerance_rad,
        points=plan.postures[0].points,
        hit_direction=test.hit_direction,
        validation=False,
        brakes=test.brakes,
        known_mass=test.known_mass,
    )
