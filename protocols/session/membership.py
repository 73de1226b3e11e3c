"""Whether a hit, or an FRF matrix given instead of hits, belongs to its session."""

from __future__ import annotations

from armodal.protocols.errors import JournalError, SessionError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Hit, Session, SessionHeader

__all__ = ["check_frf_membership", "check_membership"]


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


def check_frf_membership(frf: FrequencyResponse, session: Session) -> None:
    """Raise SessionError unless given FRFs fit plan and arm and stand in for hits."""
    what = f"FRFs of {frf.posture!r}"
    arm, plan = session.header.arm, session.header.plan
    if all(posture.name != frf.posture for posture in plan.postures):
        raise SessionError(f"{what}: the plan has no such posture")
    if sum(other.posture == frf.posture for other in session.frfs) > 1:
        raise SessionError(f"{what}: one FRF matrix a posture was wanted, several came")
    if any(hit.posture == frf.posture for hit in session.hits):
        raise SessionError(f"{what}: FRFs were given for a posture that has hits")
    known = {point.id for point in arm.points}
    for dof in (*frf.responses, *frf.references):
        if dof.point not in known:
            raise SessionError(f"{what}: the arm has no point {dof.point!r}")
    if frf.joints_rad is not None and len(frf.joints_rad) != len(arm.joints):
        raise SessionError(
            f"{what}: the arm has {len(arm.joints)} joints, {len(frf.joints_rad)} angles came"
        )
