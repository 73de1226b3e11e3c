"""Whether a hit belongs to the session it is found in."""

from __future__ import annotations

from protocols.errors import JournalError
from protocols.session.records import Hit, SessionHeader

__all__ = ["check_membership"]


def check_membership(hit: Hit, header: SessionHeader, previous: Hit | None) -> None:
    """Raise JournalError unless `hit` fits plan, arm and board, and follows `previous`."""
    what = f"hit {hit.number}"
    channels = header.channel_mask.bit_count()
    if hit.counts.shape[1] != channels:
        raise JournalError(
            f"{what}: {channels} channels are configured, {hit.counts.shape[1]} were recorded"
        )
    if previous is not None and hit.number <= previous.number:
        raise JournalError(f"{what} follows hit {previous.number}: numbers have to rise")
    if all(posture.name != hit.posture for posture in header.plan.postures):
        raise JournalError(f"{what}: the plan has no posture {hit.posture!r}")
    for name in (hit.sensor_point, hit.hit_point):
        if all(point.id != name for point in header.arm.points):
            raise JournalError(f"{what}: the arm has no point {name!r}")
    for reading in (hit.before, hit.after):
        joints = reading.joints_rad
        if joints is not None and len(joints) != len(header.arm.joints):
            raise JournalError(
                f"{what}: the arm has {len(header.arm.joints)} joints, {len(joints)} angles came"
            )
