"""How long a plan takes: what people need, and what the records last."""

from __future__ import annotations

from armodal.protocols.plan_records import Plan

__all__ = ["minutes"]

# Of a practised operator: the arm moved, its brakes or servos settled; a sensor taken off, waxed on
# and turned; a hit aimed, and thought about.
POSTURE_S = 180.0
MOUNTING_S = 75.0
HIT_S = 8.0


def minutes(plan: Plan) -> float:
    """Minutes from the first posture to the last hit, without a hit refused."""
    record_s = plan.sampling.samples / float(plan.sampling.rate_hz)
    total = 0.0
    for posture in plan.postures:
        hits = plan.hits_per_point * (HIT_S + record_s)
        total += POSTURE_S + len(posture.points) * (MOUNTING_S + hits)
    return total / 60.0
