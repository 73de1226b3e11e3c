"""Did the arm stand where it should, and stay there? Judged on the bus's angles."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from armodal.daq.joint_state import largest_difference_rad
from armodal.protocols.session.records import JointReading, Verdict

__all__ = ["judge_posture", "with_posture"]


def judge_posture(
    before: JointReading,
    after: JointReading,
    planned_rad: npt.NDArray[np.float64],
    tolerance_rad: float,
    moved_rad: float,
    spread_rad: float | None = None,
    silence: str = "",
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return reasons and notes against a hit from the readings around it.

    Parameters
    ----------
    before, after
        Readings not later than the block's first sample, and later than its last.
    planned_rad : (n_joints,)
        The posture wanted.
    tolerance_rad
        Largest distance of any joint from it.
    moved_rad
        Largest distance of any joint between the two readings, or on the way.
    spread_rad
        Largest range any joint covered from `before` to `after`, None where it is not known.
    silence
        A sentence where nothing was known of the arm for too long in between.
    """
    reasons: list[str] = []
    notes: list[str] = []
    known = []
    for word, reading in (("before", before), ("after", after)):
        if reading.joints_rad is None:
            absent = math.isinf(reading.age_s)
            reasons.append("absent" if absent else "stale")
            notes.append(
                f"no joint angles {word} the hit"
                + ("" if absent else f": the last are {reading.age_s:.3g} s old")
            )
            continue
        if not reading.held:
            reasons.append("not-held")
            notes.append(f"{word} the hit the drives do not hold the arm")
        known.append(reading.joints_rad)
        off_rad = largest_difference_rad(reading.joints_rad, planned_rad)
        if off_rad > tolerance_rad:
            reasons.append("posture")
            joint = int(np.abs(reading.joints_rad - planned_rad).argmax()) + 1
            notes.append(
                f"{word} the hit joint {joint} is {math.degrees(off_rad):.2f} deg off, "
                f"{math.degrees(tolerance_rad):.2f} allowed"
            )
    if len(known) == 2:
        change_rad = max(largest_difference_rad(known[0], known[1]), spread_rad or 0.0)
        if silence:
            reasons.append("stale")
            notes.append(silence)
        if change_rad > moved_rad:
            reasons.append("moved")
            notes.append(
                f"a joint moved by {math.degrees(change_rad):.3f} deg during the hit, "
                f"{math.degrees(moved_rad):.3f} allowed"
            )
    return tuple(dict.fromkeys(reasons)), tuple(notes)


def with_posture(verdict: Verdict, judged: tuple[tuple[str, ...], tuple[str, ...]]) -> Verdict:
    """Return the verdict of record and posture together."""
    reasons = verdict.reasons + judged[0]
    return Verdict(
        accepted=not reasons,
        reasons=reasons,
        notes=verdict.notes + judged[1],
        peak_n=verdict.peak_n,
        width_s=verdict.width_s,
        polarity=verdict.polarity,
    )
