"""What an acquisition process is started with."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from armodal.daq.board_link import GIVE_UP_WALL_S
from armodal.daq.clock import check_time_scale
from armodal.daq.controller import Controller
from armodal.daq.judge import JudgeLimits
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlanError
from armodal.protocols.plan_records import Plan

__all__ = ["AcquisitionSettings"]

MOST_BLOCKS = 8
BYTES_PER_SAMPLE = 16  # counts, their copy, presence, and the judge's working arrays


@dataclass(frozen=True, slots=True, kw_only=True)
class AcquisitionSettings:
    """Settings of one acquisition process; times are lab seconds.

    board_port : path of the board's serial line
    board_baud : bit rate of a UART; without meaning for USB lines and pseudo-terminals
    can_channel : path of a serial CAN adapter, or interface:channel of python-can
    controller : what tells joint angles in place of the bus
    told_tolerance_rad : joint angles are told by a person, to so much; None: they are measured
    measured_by : who measures, for the report; kept as the session began
    journal : file to begin, or with `resume` to go on with
    mirror : folder on another disk that keeps the journal too, durable before a hit counts
    time_scale : lab seconds per second; 1 in a real laboratory
    session_id : hex; drawn when None
    reply_timeout_s : wait for a reply of the board before asking again
    give_up_wall_s : a command is given at least so long, in seconds of this computer
    can_timeout_s : wait at the start for an angle of every joint
    still_s : the joints must have been still for so long before a posture counts as reached
    settle_s : a hit's `after` angles must be newer than the block's end by one turn of the loop;
        they are waited for at most so long
    stream : whether the board is asked for its preview
    teds_confirmed : somebody has seen where sensors and board contradict each other
    input_range_v : largest voltage of the board's inputs, to compare sensitivities by; a front-end
        file tells its own
    sensor_memory : file of the sensitivities that sensors were last used with; None: not compared
    max_memory : bytes for blocks in the making
    """

    board_port: str
    arm: Arm
    plan: Plan
    journal: Path
    mirror: Path | None = None
    can_channel: str = ""
    controller: Controller | None = None
    told_tolerance_rad: float | None = None
    measured_by: str = ""
    resume: bool = False
    board_baud: int = 921_600
    time_scale: float = 1.0
    session_id: str | None = None
    software: str = "armodal"
    reply_timeout_s: float = 0.5
    give_up_wall_s: float = GIVE_UP_WALL_S
    can_timeout_s: float = 3.0
    still_s: float = 0.3
    settle_s: float = 0.5
    stream: bool = True
    teds_confirmed: bool = False
    input_range_v: float | None = None
    sensor_memory: Path | None = None
    max_memory: int = 64 * 2**20
    limits: JudgeLimits = field(default_factory=JudgeLimits)

    def __post_init__(self) -> None:
        """Refuse a time scale that no clock can have."""
        check_time_scale(self.time_scale)

    @property
    def has_joint_source(self) -> bool:
        """Whether it is said where joint angles come from."""
        return self.without_bus or bool(self.can_channel)

    @property
    def without_bus(self) -> bool:
        """Whether joint angles come from elsewhere than a bus."""
        return self.told_tolerance_rad is not None or self.controller is not None

    def blocks_in_memory(self, n_channels: int) -> int:
        """Return how many blocks may be put together at a time.

        Raises
        ------
        PlanError
            If not even one fits.
        """
        block = BYTES_PER_SAMPLE * n_channels * self.plan.sampling.samples
        if block > self.max_memory:
            raise PlanError(
                f"a block of {self.plan.sampling.samples} samples x {n_channels} channels takes "
                f"{block} bytes of memory, {self.max_memory} are allowed: sample shorter blocks"
            )
        return min(MOST_BLOCKS, self.max_memory // block)
