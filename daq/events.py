"""What the acquisition process says, each a record that cannot change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.daq.session_machine import Progress, Prompt
from armodal.protocols.arm.records import Arm
from armodal.protocols.board.records import BoardDictionary, BoardStatus
from armodal.protocols.session.records import Hit, JointReading, Loss, Verdict

__all__ = [
    "BoardFound",
    "DeviceTrouble",
    "Event",
    "Failed",
    "Finished",
    "Health",
    "HitJudged",
    "HitWithdrawn",
    "JointsSeen",
    "LossNoted",
    "Noted",
    "PointMoved",
    "Preview",
    "Prompted",
    "SessionOpened",
    "TrialHit",
    "is_preview",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardFound:
    """The board answered and was configured."""

    port: str
    dictionary: BoardDictionary
    channel_mask: int


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviceTrouble:
    """Before a session: a device cannot be used, and is tried again; None when it can."""

    device: str  # "board" or "can"
    message: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialHit:
    """Before a session: a hit for trial, judged and kept nowhere."""

    counts: npt.NDArray[np.int32]  # (n_samples, n_channels)
    first_sample: int
    trigger_sample: int
    verdict: Verdict
    force_noise_n: float  # standard deviation before the trigger


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionOpened:
    """The journal is open; hits already in it where the session is resumed."""

    session_id: str
    journal: str
    hits_before: int
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Prompted:
    """Something is asked of the operator."""

    prompt: Prompt
    host_s: float
    progress: tuple[Progress, ...]  # of every planned point, in the plan's order


@dataclass(frozen=True, slots=True, kw_only=True)
class HitJudged:
    """A hit was judged, and is durable.

    The figures are wall seconds: from reading the last sample to the verdict, and for making the
    record durable.
    """

    hit: Hit
    verdict_s: float
    commit_s: float
    clock_uncertainty_s: float  # of the hit's trigger_host_s, lab seconds


@dataclass(frozen=True, slots=True, kw_only=True)
class HitWithdrawn:
    """An accepted hit was taken back; the journal says so."""

    number: int
    posture: str
    point: str  # the roving one


@dataclass(frozen=True, slots=True, kw_only=True)
class PointMoved:
    """A test point was moved; the journal says so. The arm has it there."""

    point: str
    arm: Arm


@dataclass(frozen=True, slots=True, kw_only=True)
class Health:
    """How board and bus do, once a second; times are lab seconds."""

    clock_uncertainty_s: float | None  # of board time on the host, now; None without a board
    clock_rate_ppm: float | None  # the board's clock against the host's
    board: BoardStatus | None  # None until its first answer
    can_frames: int  # decoded since the start
    can_faults: int
    stream_samples: int


@dataclass(frozen=True, slots=True, kw_only=True)
class JointsSeen:
    """Where the arm stands, a few times a second."""

    reading: JointReading


@dataclass(frozen=True, slots=True, kw_only=True)
class Preview:
    """Lowest and highest counts of each channel since the preview before."""

    first_sample: int
    n_samples: int
    lowest: npt.NDArray[np.int32]  # (n_bins, n_channels)
    highest: npt.NDArray[np.int32]  # (n_bins, n_channels)


@dataclass(frozen=True, slots=True, kw_only=True)
class LossNoted:
    """Something did not arrive; it is in the journal."""

    loss: Loss


@dataclass(frozen=True, slots=True, kw_only=True)
class Noted:
    """A sentence for the operator; kept in the journal too."""

    text: str
    host_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Finished:
    """The session has ended by itself or on request; the journal is closed."""

    complete: bool
    reason: str
    journal: str
    accepted: int
    rejected: int
    cpu_s: float  # processor time of the loop, with all threads of the process
    previews_dropped: int
    samples_taken: int | None  # by the board since START; None where it did not tell at the end
    samples_seen: int  # of them came in the preview


@dataclass(frozen=True, slots=True, kw_only=True)
class Failed:
    """The session cannot go on; what was accepted is safe in the journal."""

    message: str
    kind: str  # name of the error's type
    journal: str | None


Event = (
    BoardFound
    | DeviceTrouble
    | TrialHit
    | SessionOpened
    | Prompted
    | HitJudged
    | HitWithdrawn
    | Health
    | JointsSeen
    | Preview
    | LossNoted
    | Noted
    | PointMoved
    | Finished
    | Failed
)


def is_preview(event: Event) -> bool:
    """Whether a later event of the same type makes this one needless."""
    return isinstance(event, Preview | JointsSeen | Health)
