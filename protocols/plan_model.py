"""The tables of a plan file and what each of their values may be."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from armodal.protocols.toml_reader import FileModel, Name, Vector3, not_wanted

__all__ = ["PlanFile", "PostureTable", "exact_rate"]

PointId = Annotated[str, Field(min_length=1, max_length=16)]

_FRACTION = re.compile(r"[0-9]{1,9}(\.[0-9]{1,9})?|[0-9]{1,9}/[1-9][0-9]{0,8}")
_U32 = 2**32 - 1  # the board is told numerator and denominator in 32 bits each
_SHORTEST_DIRECTION = 1e-3


def exact_rate(value: float | str) -> Fraction:
    """Return a rate as the fraction the file wrote: "51200/31", 51200 or 1652.5.

    Raises
    ------
    ValueError
        If the text is no such number.

    >>> exact_rate("51200/31")
    Fraction(51200, 31)
    """
    text = str(value)
    if not _FRACTION.fullmatch(text):
        raise ValueError(text)
    rate = Fraction(text)
    if rate.numerator > _U32 or rate.denominator > _U32:
        raise ValueError(text)
    return rate


class SamplingTable(FileModel):
    """Sampling of one hit; the pre-trigger is part of the block."""

    rate_hz: int | float | str
    samples: Annotated[int, Field(ge=64, le=1_048_576)]
    pretrigger: Annotated[int, Field(ge=0)]

    @field_validator("rate_hz", mode="before")
    @classmethod
    def _check_rate(cls, value: object) -> object:
        wanted = 'a rate from 1 to 1000000 Hz, as a number or a fraction such as "51200/31"'
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise not_wanted(wanted)
        try:
            rate = exact_rate(value)
        except ValueError as problem:
            raise not_wanted(wanted) from problem
        if not 1 <= rate <= 1_000_000:
            raise not_wanted(wanted)
        return value

    @model_validator(mode="after")
    def _check_pretrigger(self) -> SamplingTable:
        if self.pretrigger >= self.samples:
            raise not_wanted("pretrigger below samples, of which it is a part")
        return self


class TriggerTable(FileModel):
    """Level on the force channel."""

    level_n: Annotated[float, Field(gt=0.0, le=1e5)]
    slope: Literal["rising", "falling"]


class WindowsTable(FileModel):
    """Windows the analysis applies."""

    exponential_end: Annotated[float, Field(gt=0.0, le=1.0)] = 1.0
    force_s: Annotated[float, Field(gt=0.0, le=1e3)] | None = None


class AveragingTable(FileModel):
    """How the hits of a point become one FRF."""

    estimator: Literal["h1", "h2", "hv"] = "h1"
    keep_hits: Annotated[int, Field(ge=1, le=100)] | None = None


class SensorTable(FileModel):
    """The accelerometer as a mass on the arm."""

    mass_kg: Annotated[float, Field(ge=0.0, le=1.0)]


class KnownMassTable(FileModel):
    """A body that the laboratory bolts on."""

    link: Name
    mass_kg: Annotated[float, Field(gt=0.0, le=1000.0)]
    center_m: Vector3


Peak = Annotated[float, Field(gt=0.0, le=1e5)]


class PostureTable(FileModel):
    """One posture and the points to measure there, in order."""

    name: Name
    joints_deg: Annotated[list[float], Field(max_length=32)]
    tolerance_deg: Annotated[float, Field(gt=0.0, le=5.0)]
    points: Annotated[list[PointId], Field(min_length=1, max_length=1000)]
    hit_direction: Vector3 | None = None
    validation: bool = False
    brakes: bool = False
    known_mass: KnownMassTable | None = None
    peaks_n: Annotated[list[Peak], Field(min_length=1, max_length=100)] | None = None

    @field_validator("hit_direction")
    @classmethod
    def _check_direction(cls, value: list[float] | None) -> list[float] | None:
        if value is not None and not _SHORTEST_DIRECTION <= math.hypot(*value) <= 1e6:
            raise not_wanted("a direction, of any length but zero")
        return value


class PlanFile(FileModel):
    """The whole file."""

    format: Literal["armodal-plan-1"]
    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")]
    arm: Name
    mode: Literal["roving-response", "roving-hammer"]
    fixed_point: PointId
    hits_per_point: Annotated[int, Field(ge=1, le=100)]
    max_attempts: Annotated[int, Field(ge=1, le=1000)]
    sampling: SamplingTable
    trigger: TriggerTable
    windows: WindowsTable = WindowsTable()
    averaging: AveragingTable = AveragingTable()
    sensor: SensorTable
    postures: Annotated[list[PostureTable], Field(min_length=1, max_length=100)]

    @model_validator(mode="after")
    def _check_attempts(self) -> PlanFile:
        if self.max_attempts < self.hits_per_point:
            raise not_wanted("max_attempts of at least hits_per_point")
        return self
