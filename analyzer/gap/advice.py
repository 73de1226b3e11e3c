"""The proposed next test as a plan: what it tells apart, and how much."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from analyzer.gap.fit import Fit, Stage
from analyzer.gap.next_test import Test, hidden_rival, proposed
from analyzer.gap.records import NextTest
from analyzer.gap.scan import Candidate
from protocols.plan_records import Plan, PlannedPosture
from protocols.plan_rewrite import text_with_posture

__all__ = ["advise"]

_SEED = 2718  # proposals are repeatable
_MOST_RIVALS = 3
_WIDE = 0.05  # of ln k: a hidden effect that moves a stiffness so far is worth a test
_WORTH = 3.0  # nats: less is not worth an hour in the lab


def advise(
    stage: Stage,
    final: Fit,
    standing: Sequence[Fit],
    hiding: Sequence[Candidate],
    largest: Callable[[Candidate], float],
    plan: Plan,
    tell: Callable[[str], None],
) -> NextTest | None:
    """Propose what tells standing rivals apart, or what narrows a joint's stiffness.

    Parameters
    ----------
    largest
        The size at which a hidden effect could still be there.

    Returns
    -------
    None where no test of the laboratory would tell enough.
    """
    rng = np.random.default_rng(_SEED)
    if len(standing) > 1:
        rivals = list(standing[:_MOST_RIVALS])
        names = [_title(fit) for fit in rivals]
        why = "tells " + " from ".join(names)
    else:
        found = _widest(final, hiding, largest)
        if found is None:
            return None
        candidate, joint = found
        rivals = [final, hidden_rival(stage, final, candidate, largest(candidate))]
        why = f"shows whether {candidate.instance.title} hides, which widens k of {joint}"
    best = proposed(stage, rivals, rng=rng, tell=tell)
    if best is None or (best[1] < _WORTH and len(standing) < 2):
        return None
    test, gain = best
    words = f"{test.words}; expected evidence {gain:.0f} nats"
    text = text_with_posture(
        plan, final.hypothesis.ordinary.arm, _posture(plan, test), comment=f"Proposed: {why}"
    )
    return NextTest(words=words, why=why, gain=gain, plan_toml=text)


def _widest(
    final: Fit, hiding: Sequence[Candidate], largest: Callable[[Candidate], float]
) -> tuple[Candidate, str] | None:
    """The hidden effect that moves a stiffness furthest, and the joint."""
    best: tuple[float, Candidate, str] | None = None
    for i in final.hypothesis.ordinary.elastic:
        joint = final.hypothesis.ordinary.arm.joints[i].name
        for candidate in hiding:
            if not candidate.begin:
                continue
            moved = abs(candidate.follow.get(f"ln k {joint}", 0.0) * largest(candidate))
            if moved > _WIDE and (best is None or moved > best[0]):
                best = moved, candidate, joint
    return None if best is None else best[1:]


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
