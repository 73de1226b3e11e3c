"""How long a plan takes: what people need, and what the records last."""

from __future__ import annotations

from armodal.protocols.plan_records import Plan

__all__ = ["minutes", "mounting_s"]

# Of a practised operator: the arm moved, its brakes or servos settled; a sensor taken off, waxed on
# and turned; a hit aimed, and thought about.
POSTURE_S = 180.0
MOUNTING_S = 75.0
HIT_S = 8.0


def minutes(plan: Plan) -> float:
    """Minutes from the first posture to the last hit, without a hit refused."""
    mountings = sum(len(posture.points) for posture in plan.postures)
    return (len(plan.postures) * POSTURE_S + mountings * mounting_s(plan)) / 60.0


def mounting_s(plan: Plan) -> float:
    """Seconds that a point takes in a posture: its sensor mounted, and its hits."""
    record_s = plan.sampling.samples / float(plan.sampling.rate_hz)
    return MOUNTING_S + plan.hits_per_point * (HIT_S + record_s)
