"""What happens in the app itself, beside the events of the acquisition process."""

from __future__ import annotations

from dataclasses import dataclass

from armodal.analyzer.ratio_calibration import RatioCalibration
from armodal.daq.events import Event
from armodal.protocols.plan_records import Plan

__all__ = [
    "HandAtWork",
    "HandIdle",
    "Happening",
    "LabEnded",
    "LabStarting",
    "LabWanted",
    "MassChosen",
    "PortsFound",
    "ProcessGone",
    "RatioConfirmed",
    "RatioFound",
    "SafeConfirmed",
    "SensorsConfirmed",
    "SessionFileReady",
    "SessionWanted",
    "Tick",
    "TriggerChosen",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Tick:
    """Time goes on; wall seconds of the app's clock."""

    now_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PortsFound:
    """Ports of this machine: path and description."""

    ports: tuple[tuple[str, str], ...]
    board_choice: str = ""  # the one taken for the board's so far


@dataclass(frozen=True, slots=True, kw_only=True)
class LabStarting:
    """The simulated laboratory is being started."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LabEnded:
    """The simulated laboratory has ended by itself."""

    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LabWanted:
    """The watch over board and bus was started with these ports."""

    board_port: str
    can_channel: str
    simulated: bool
    input_range_v: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class TriggerChosen:
    """The operator has set the trigger level for the session; the plan has it."""

    plan: Plan


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorsConfirmed:
    """The operator says that the sensors of the dictionary are those mounted."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MassChosen:
    """Trial hits are on a known mass from now on; None: on the arm again."""

    mass_kg: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RatioFound:
    """What the hits on the known mass say of hammer and accelerometer together."""

    calibration: RatioCalibration


@dataclass(frozen=True, slots=True, kw_only=True)
class RatioConfirmed:
    """The operator has seen by how much hammer and accelerometer are off, and goes on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionWanted:
    """The acquisition process was started."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SafeConfirmed:
    """The operator has seen that the arm is held, and says that it is safe to approach."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HandAtWork:
    """The simulated operator does something."""

    doing: str


@dataclass(frozen=True, slots=True, kw_only=True)
class HandIdle:
    """The simulated operator has finished; `trouble` says why it could not."""

    trouble: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcessGone:
    """The acquisition process ended without an event; its last words, if it had any."""

    last_word: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionFileReady:
    """The session file was derived from the journal; `problem` says why it was not."""

    path: str
    problem: str | None = None


Happening = (
    Event
    | Tick
    | PortsFound
    | LabEnded
    | LabStarting
    | LabWanted
    | TriggerChosen
    | SensorsConfirmed
    | MassChosen
    | RatioFound
    | RatioConfirmed
    | SessionWanted
    | SafeConfirmed
    | HandAtWork
    | HandIdle
    | ProcessGone
    | SessionFileReady
)
