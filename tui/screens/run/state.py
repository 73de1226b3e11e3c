"""What the screens show, as one record that never changes in place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from armodal.analyzer.ratio_calibration import RatioCalibration
from armodal.daq.events import (
    BoardFound,
    Failed,
    Finished,
    Health,
    HitJudged,
    Preview,
    SessionOpened,
    TrialHit,
)
from armodal.daq.session_machine import Progress, Prompt, PromptKind, begin
from armodal.protocols.arm.records import Arm
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.plan_records import Mode, Plan
from armodal.protocols.sensor_memory import KnownSensor
from armodal.protocols.session.journal import Mark
from armodal.protocols.session.records import Hit, JointReading

__all__ = ["FEWEST_MASS_HITS", "RATIO_OFF", "Phase", "RunState", "begin_state"]

FEWEST_MASS_HITS = 3  # on a known mass, before they tell anything
RATIO_OFF = 0.03  # what two certificates of 1.5 % leave open
SILENT_AFTER_S = 1.0  # wall seconds without word of the joints, after which nothing is known


class Phase(StrEnum):
    """What runs."""

    LAB = "lab"  # before the session
    OPENING = "opening"
    SESSION = "session"
    FAILED = "failed"
    ENDED = "ended"


@dataclass(frozen=True, slots=True, kw_only=True)
class RunState:
    """The whole state of the operator's app."""

    arm: Arm
    plan: Plan
    phase: Phase = Phase.LAB
    now_s: float = 0.0  # wall seconds of the app's clock
    time_scale: float = 1.0
    # lab
    ports: tuple[tuple[str, str], ...] = ()
    board_choice: str = ""  # chosen from the list, before the controller's port is
    board_port: str = ""
    can_channel: str = ""
    told_rad: float | None = None  # the operator tells joint angles, to so much; None: measured
    input_range_v: float | None = None  # of the board's inputs; its dictionary does not tell it
    known_sensors: Mapping[str, KnownSensor] = field(default_factory=dict)  # as last used
    simulated: bool = False
    lab_starting: bool = False
    lab_ended: str | None = None  # why the simulated laboratory has ended by itself
    troubles: tuple[tuple[str, str], ...] = ()  # device, message
    board: BoardFound | None = None
    health: Health | None = None
    previews: tuple[Preview, ...] = ()
    trials: tuple[TrialHit, ...] = ()
    mass_kg: float | None = None  # of the known mass, while it is hit
    mass_hits: tuple[TrialHit, ...] = ()
    ratio: RatioCalibration | None = None
    ratio_confirmed: bool = False  # as it is, where it is off
    sensors_confirmed: bool = False
    # session
    earlier_hits: tuple[Hit, ...] = ()
    earlier_end: str | None = None  # how the earlier part of this session ended
    other_frfs: tuple[FrequencyResponse, ...] = ()  # of another session of this arm
    std_wanted: float | None = None  # of the FRF at its strongest resonance, relative
    opened: SessionOpened | None = None
    prompt: Prompt | None = None
    progress: tuple[Progress, ...] = ()
    reading: JointReading | None = None
    reading_at_s: float | None = None  # wall seconds
    held_at_s: float | None = None  # wall seconds at which the arm was last known to be held
    safe: bool = False
    hits: tuple[HitJudged, ...] = ()  # of this run of the app, in order
    withdrawn: frozenset[int] = frozenset()  # numbers of hits
    last_taken_back: int | None = None  # number, until the next hit
    losses: tuple[tuple[str, int], ...] = ()  # kind, count
    notes: tuple[str, ...] = ()
    finished: Finished | None = None
    failed: Failed | None = None
    session_file: str | None = None
    file_problem: str | None = None
    # the simulated operator
    hand_doing: str | None = None
    hand_did: str | None = None  # what it finished last

    @property
    def joints(self) -> JointReading | None:
        """The last word of the joints, None when it is too old to be believed."""
        if self.reading is None or self.reading_at_s is None:
            return None
        if self.now_s - self.reading_at_s > SILENT_AFTER_S:
            return None
        return self.reading

    @property
    def posture_known(self) -> bool:
        """Whether every joint's angle is known now."""
        return self.joints is not None and self.joints.joints_rad is not None

    @property
    def angles_will_come(self) -> bool:
        """Whether joint angles are known now, or the operator will tell them at each posture."""
        return self.told_rad is not None or self.posture_known

    @property
    def awaits_word(self) -> bool:
        """Whether the operator is to tell now where the arm stands."""
        at_posture = self.prompt is not None and self.prompt.kind is PromptKind.POSTURE
        return self.phase is Phase.SESSION and self.told_rad is not None and at_posture

    @property
    def held(self) -> bool | None:
        """Whether the drives hold the arm; None when that is not known."""
        return self.joints.held if self.joints is not None and self.posture_known else None

    @property
    def ratio_asks(self) -> bool:
        """Whether hammer and accelerometer were found off, and the operator has not said yes."""
        found = self.ratio
        if found is None or self.ratio_confirmed or self.mass_kg is not None:
            return False
        return found.n_hits >= FEWEST_MASS_HITS and abs(found.ratio - 1.0) > RATIO_OFF

    @property
    def resuming(self) -> bool:
        """Whether the session was begun before."""
        return bool(self.earlier_hits) or self.earlier_end is not None

    @property
    def last_hit(self) -> HitJudged | None:
        """The last hit that was judged since the app began."""
        return self.hits[-1] if self.hits else None

    @property
    def here(self) -> tuple[str, str] | None:
        """Posture and roving point in hand."""
        prompt = self.prompt
        if prompt is None or prompt.posture is None:
            return None
        roving = self.plan.mode is Mode.ROVING_RESPONSE
        return prompt.posture.name, prompt.sensor_point if roving else prompt.hit_point


def begin_state(
    arm: Arm,
    plan: Plan,
    *,
    time_scale: float = 1.0,
    told_rad: float | None = None,
    earlier_hits: tuple[Hit, ...] = (),
    earlier_marks: tuple[Mark, ...] = (),
    earlier_end: str | None = None,
) -> RunState:
    """Return the state at the start of the app, with what an earlier run has left."""
    return RunState(
        arm=arm,
        plan=plan,
        time_scale=time_scale,
        told_rad=told_rad,
        earlier_hits=earlier_hits,
        earlier_end=earlier_end,
        progress=begin(plan, earlier_hits, earlier_marks).progress,
    )
