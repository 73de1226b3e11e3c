"""What `armodal run` was started with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from armodal.daq.controller import Controller
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.sensor_memory import KnownSensor
from armodal.tui.screens.run.place import SessionPlace

__all__ = ["RunOptions"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """What `armodal run` was started with."""

    place: SessionPlace
    board: str = ""
    can: str = ""
    controller: Controller | None = None  # tells joint angles in place of the bus
    arm_folder: Path | None = None  # where the arm file and its meshes lie
    told_rad: float | None = None  # joint angles are told by the operator, to so much
    measured_by: str = ""
    mirror: Path | None = None  # folder of the journal's copy
    baud: int = 921_600
    input_range_v: float | None = None
    sensor_memory: Path | None = None  # where sensors are remembered
    known_sensors: Mapping[str, KnownSensor] = field(default_factory=dict)
    simulated: bool = False
    hidden: tuple[tuple[str, str | float], ...] = ()  # in the simulated arm
    seed: int = 1
    time_scale: float = 1.0
    earlier: tuple[FrequencyResponse, ...] = ()  # of another session of the arm, as it may have
    std_wanted: float | None = None  # of the FRF at its strongest resonance, relative
    software: str = "armodal"

    @property
    def joint_source(self) -> str:
        """Where joint angles come from, in place of the bus; empty: from the bus, or a person."""
        return "" if self.controller is None else self.controller.address

    @property
    def without_bus(self) -> bool:
        """Whether joint angles come from elsewhere than a port of this computer."""
        return bool(self.joint_source) or self.told_rad is not None
