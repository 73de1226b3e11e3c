"""Records of a measured session: what the journal keeps and the session file lays out."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import Arm
from armodal.protocols.board.records import BoardDictionary
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.plan_records import Plan

__all__ = ["Hit", "JointReading", "Loss", "Session", "SessionHeader", "Verdict"]


@dataclass(frozen=True, slots=True, kw_only=True)
class JointReading:
    """Joint angles as the bus told them, or why they are not known.

    `joints_rad` is None when any joint was absent or stale: no angle is ever assumed.
    """

    joints_rad: npt.NDArray[np.float64] | None  # (n_joints,)
    drive_state: int | None
    held: bool
    age_s: float  # of the oldest signal used; inf when absent
    host_s: float  # host clock at the reading


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """The judge's word on one hit.

    `reasons` are codes of the field (double, overload, soft, late, gap, posture, moved, stale,
    not-held ...), empty when accepted; `notes` are sentences that do not reject. `polarity` is the
    sign of the recorded force when the hammer pushes: -1 for a reversed hammer.
    """

    accepted: bool
    reasons: tuple[str, ...]
    notes: tuple[str, ...]
    peak_n: float
    width_s: float
    polarity: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """Something that did not arrive, with its extent, and where it was noticed."""

    kind: str  # "stream", "block", "trigger", "can", "frame"
    count: int
    first_sample: int | None
    host_s: float
    note: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Hit:
    """One captured hit, accepted or not."""

    number: int  # from 1, in order of capture, over the whole session
    posture: str
    sensor_point: str
    hit_point: str
    hit_direction: npt.NDArray[np.float64]  # (3,) unit, base frame, as planned
    first_sample: int
    trigger_sample: int
    trigger_host_s: float
    counts: npt.NDArray[np.int32]  # (n_samples, n_channels), gaps never filled
    before: JointReading
    after: JointReading
    verdict: Verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionHeader:
    """What is fixed when a session begins."""

    session_id: str  # hex
    created: str  # ISO 8601, UTC
    software: str
    arm: Arm
    plan: Plan
    dictionary: BoardDictionary
    dictionary_bytes: bytes
    channel_mask: int
    time_scale: float  # 1 in a real laboratory
    told_tolerance_rad: float | None = None  # joint angles were told to so much; None: measured
    measured_by: str = ""  # who held the hammer; empty: not told


@dataclass(frozen=True, slots=True, kw_only=True)
class Session:
    """A whole session in memory.

    `frfs` are FRF matrices that were given instead of hits, one a posture: averaged elsewhere
    and imported. A posture has either hits or such an FRF matrix.

    Attributes
    ----------
    header : SessionHeader
        Arm, plan, board and time, fixed when the session begins.
    hits : tuple of Hit
        In order of capture, accepted or not; counts (n_samples, n_channels), directions in the
        base frame.
    losses : tuple of Loss
        What did not arrive, by kind and count.
    complete : bool
        Whether every planned point has its accepted hits.
    warnings : tuple of str
        Of reading the file.
    frfs : tuple of FrequencyResponse
        Given in place of hits.
    """

    header: SessionHeader
    hits: tuple[Hit, ...]
    losses: tuple[Loss, ...]
    complete: bool
    warnings: tuple[str, ...] = field(default=())
    frfs: tuple[FrequencyResponse, ...] = field(default=())

    def accepted(self, posture: str | None = None) -> tuple[Hit, ...]:
        """Return the accepted hits, of one posture or of all."""
        return tuple(
            hit
            for hit in self.hits
            if hit.verdict.accepted and (posture is None or hit.posture == posture)
        )
