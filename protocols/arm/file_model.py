"""The tables of an arm file and what each of their values may be."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from armodal.protocols.arm.effect_section import EffectTable, PastSessionTable
from armodal.protocols.toml_reader import FileModel, Name, Vector3, not_wanted

__all__ = [
    "ArmFile",
    "CanSection",
    "JointTable",
    "KeepOutTable",
    "LinkTable",
    "MassesTable",
    "PointTable",
]


# How far from unit length and from perpendicular a direction may be written: three decimals.
_DIRECTION = 2e-3

Positive = Annotated[float, Field(gt=0.0, lt=1e12)]
Relative = Annotated[float, Field(gt=0.0, le=1.0)]
SmallAngleDeg = Annotated[float, Field(gt=0.0, le=30.0)]
Position = Annotated[
    list[Annotated[float, Field(ge=-100.0, le=100.0)]], Field(min_length=3, max_length=3)
]
SixNumbers = Annotated[list[float], Field(min_length=6, max_length=6)]
# A name beside the arm file or a shipped one: never a path.
FileName = Annotated[
    str, Field(max_length=64, pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]*(\.[A-Za-z0-9_-]+)*$")
]


class EstimateTable(FileModel):
    """A belief: value, one standard deviation, and where it comes from."""

    value: Positive
    std: Positive
    source: Annotated[str, Field(min_length=1, max_length=400)]


class DhTable(FileModel):
    """One modified Denavit-Hartenberg row (Craig)."""

    alpha_deg: Annotated[float, Field(ge=-360.0, le=360.0)]
    a_m: Annotated[float, Field(ge=-100.0, le=100.0)]
    theta_offset_deg: Annotated[float, Field(ge=-360.0, le=360.0)]
    d_m: Annotated[float, Field(ge=-100.0, le=100.0)]


class LinkTable(FileModel):
    """The inertials of a link; with a URDF they replace the URDF's.

    Either mass, centre and inertia, or a volume that `masses` turns into a mass. With a volume
    the spread of the mass is a full box, the inertia over the mass, or the URDF's own.
    """

    name: Name
    mass_kg: Positive | None = None
    volume_m3: Positive | None = None
    center_m: Position | None = None
    # ixx, iyy, izz, ixy, ixz, iyz about the centre of mass, in link axes
    inertia_kg_m2: SixNumbers | None = None
    inertia_over_mass_m2: SixNumbers | None = None  # of uniform density, whatever it is
    box_m: (
        Annotated[list[Annotated[float, Field(gt=0.0, le=10.0)]], Field(min_length=3, max_length=3)]
        | None
    ) = None

    @model_validator(mode="after")
    def _check_way(self) -> LinkTable:
        spreads = (self.box_m is not None) + (self.inertia_over_mass_m2 is not None)
        if self.volume_m3 is None:
            for key in ("mass_kg", "center_m", "inertia_kg_m2"):
                if getattr(self, key) is None:
                    raise not_wanted(
                        f"{key}, since a link without volume_m3 gives mass_kg, center_m and "
                        "inertia_kg_m2"
                    )
            if spreads:
                raise not_wanted("box_m and inertia_over_mass_m2 only with volume_m3")
            return self
        if self.mass_kg is not None or self.inertia_kg_m2 is not None:
            raise not_wanted("volume_m3 or mass_kg with inertia_kg_m2, not both")
        if spreads != (self.center_m is not None):
            raise not_wanted(
                "center_m with either box_m or inertia_over_mass_m2, or none of the three where a "
                "URDF gives them"
            )
        return self


class InertialStdTable(FileModel):
    """One standard deviation of one link's inertial, and whether its shape alone tells it."""

    mass: Relative
    inertia: Relative
    center_m: Annotated[float, Field(gt=0.0, le=1.0)]
    guessed: bool = False


class JointTable(FileModel):
    """One joint; a joint without stiffness is believed rigid while it is held."""

    name: Name
    range_deg: Annotated[list[float], Field(min_length=2, max_length=2)] | None = None
    stiffness_n_m_per_rad: EstimateTable | None = None
    damping_n_m_s_per_rad: EstimateTable | None = None
    inertial_std: InertialStdTable | None = None
    dh: DhTable | None = None
    link: LinkTable | None = None

    @field_validator("range_deg")
    @classmethod
    def _check_range(cls, value: list[float] | None) -> list[float] | None:
        if value is not None and not -3600.0 <= value[0] < value[1] <= 3600.0:
            raise not_wanted("lower before upper, both within 3600 degrees")
        return value

    @model_validator(mode="after")
    def _check_damping(self) -> JointTable:
        if (self.stiffness_n_m_per_rad is None) != (self.damping_n_m_s_per_rad is None):
            raise not_wanted(
                "stiffness_n_m_per_rad and damping_n_m_s_per_rad together, or neither for a "
                "rigid joint"
            )
        return self


class MassesTable(FileModel):
    """How links that give a volume get their mass: one density for all."""

    total_kg: Positive | None = None
    base_volume_m3: Annotated[float, Field(ge=0.0, lt=1e3)] | None = None
    density_kg_m3: Positive | None = None
    source: Annotated[str, Field(min_length=1, max_length=400)]

    @model_validator(mode="after")
    def _check_way(self) -> MassesTable:
        if (self.total_kg is None) == (self.density_kg_m3 is None):
            raise not_wanted("either total_kg or density_kg_m3")
        if (self.total_kg is None) != (self.base_volume_m3 is None):
            raise not_wanted(
                "base_volume_m3 with total_kg, and only with it: the volume of what does not move, "
                "0.0 where the total leaves it out"
            )
        return self


class PointTable(FileModel):
    """A test point: sensor z along the outward normal, sensor x along `x_axis`."""

    id: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]{1,16}$")]
    link: Name
    position_m: Position
    normal: Vector3
    x_axis: Vector3

    @field_validator("normal", "x_axis")
    @classmethod
    def _check_unit(cls, value: list[float]) -> list[float]:
        length = math.hypot(*value)
        if abs(length - 1.0) > _DIRECTION:
            raise not_wanted(f"a vector of length 1 (this one has {length:.4g})")
        return value

    @model_validator(mode="after")
    def _check_perpendicular(self) -> PointTable:
        cosine = float(np.dot(self.normal, self.x_axis))
        if abs(cosine) > _DIRECTION:
            raise not_wanted(
                f"x_axis perpendicular to normal (the angle is "
                f"{math.degrees(math.acos(max(-1.0, min(1.0, cosine)))):.2f} degrees)"
            )
        return self


class KeepOutTable(FileModel):
    """A box along the base's axes that the arm has to stay out of."""

    name: Name
    low_m: Position
    high_m: Position

    @model_validator(mode="after")
    def _check_size(self) -> KeepOutTable:
        if not all(low < high for low, high in zip(self.low_m, self.high_m, strict=True)):
            raise not_wanted("low_m below high_m in x, y and z")
        return self


class TolerancesTable(FileModel):
    """One standard deviation of what is only roughly known; a key that is left out is usual."""

    mass: Relative = 0.05
    inertia: Relative = 0.06
    center_m: Annotated[float, Field(gt=0.0, le=1.0)] = 0.003
    encoder_offset_deg: SmallAngleDeg = 0.15
    sensor_tilt_deg: SmallAngleDeg = 0.9
    sensor_gain: Relative = 0.011
    hammer_gain: Relative = 0.02
    hit_direction_deg: SmallAngleDeg = 1.4
    moving_mass: Relative | None = None


class SignalTable(FileModel):
    """A signal of the database."""

    message: Name
    signal: Name


class DriveStateTable(SignalTable):
    """The drive state and the values that mean held by the servos."""

    held_values: Annotated[list[int], Field(min_length=1, max_length=64)]


class JointSignalTable(SignalTable):
    """Where a joint's angle is found, and its unit, sign and zero."""

    joint: Name
    scale_deg: Positive | None = None
    counts_per_revolution: Positive | None = None
    gear_ratio: Positive | None = None
    sign: Literal[-1, 1]
    offset_deg: Annotated[float, Field(ge=-3600.0, le=3600.0)]

    @model_validator(mode="after")
    def _check_scale(self) -> JointSignalTable:
        by_counts = self.counts_per_revolution is not None, self.gear_ratio is not None
        if by_counts not in {(True, True), (False, False)} or any(by_counts) == (
            self.scale_deg is not None
        ):
            raise not_wanted("either scale_deg, or counts_per_revolution and gear_ratio")
        return self

    @property
    def scale_rad(self) -> float:
        """Joint radians per unit of the signal."""
        if self.scale_deg is not None:
            return math.radians(self.scale_deg)
        counts = (self.counts_per_revolution or math.nan) * (self.gear_ratio or math.nan)
        return 2.0 * math.pi / counts


class CanSection(FileModel):
    """How the controller's frames map to joints."""

    database: FileName
    bitrate: Annotated[int, Field(ge=10_000, le=1_000_000)]
    rate_hz: Annotated[float, Field(gt=0.0, le=10_000.0)]
    stale_after_s: Annotated[float, Field(gt=0.0, le=10.0)]
    joints: Annotated[list[JointSignalTable], Field(min_length=1, max_length=32)]
    drive_state: DriveStateTable | None = None
    counter: SignalTable | None = None

    @model_validator(mode="after")
    def _check_stale(self) -> CanSection:
        if self.stale_after_s * self.rate_hz < 1.0:
            raise not_wanted("stale_after_s of at least one period of rate_hz")
        return self


class ArmFile(FileModel):
    """The whole file."""

    format: Literal["armodal-arm-1"]
    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")]
    source: Annotated[str, Field(min_length=1, max_length=2000)]
    urdf: FileName | None = None
    gravity_m_s2: Annotated[
        list[Annotated[float, Field(ge=-100.0, le=100.0)]], Field(min_length=3, max_length=3)
    ] = Field(default=[0.0, 0.0, -9.80665])
    # No joints: a plain structure, all of whose points are on its base.
    joints: Annotated[list[JointTable], Field(max_length=32)]
    masses: MassesTable | None = None
    points: Annotated[list[PointTable], Field(min_length=1, max_length=1000)]
    groups: Annotated[
        dict[Name, Annotated[list[str], Field(min_length=1)]], Field(max_length=100)
    ] = Field(default={})
    tolerances: TolerancesTable = Field(default_factory=TolerancesTable)
    can: CanSection | None = None
    effects: Annotated[list[EffectTable], Field(max_length=32)] = Field(default=[])
    history: Annotated[list[PastSessionTable], Field(max_length=256)] = Field(default=[])
    keep_outs: Annotated[list[KeepOutTable], Field(max_length=32)] = Field(default=[])
