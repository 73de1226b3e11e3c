"""A laboratory's hammers and accelerometers: `sensors.toml`, specified in docs/own-arm.md."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from armodal.protocols.errors import PlanError
from armodal.protocols.toml_reader import FileModel, Name, parse_toml, read_text, validate

__all__ = ["CATALOGUE", "Accelerometer", "Equipment", "Hammer", "load_equipment"]

_LIMIT = 64 * 1024
Above = Annotated[float, Field(gt=0.0, lt=1e9)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Hammer:
    """An instrumented hammer."""

    name: str
    head_kg: float
    range_n: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Accelerometer:
    """A triaxial accelerometer."""

    name: str
    mass_kg: float
    range_m_s2: float
    noise: float  # m/s²/sqrt(Hz), one-sided, near 10 Hz


@dataclass(frozen=True, slots=True, kw_only=True)
class Equipment:
    """What a laboratory has to choose from."""

    source: str
    hammers: tuple[Hammer, ...]
    accelerometers: tuple[Accelerometer, ...]


class _HammerTable(FileModel):
    name: Name
    head_kg: Above
    range_n: Above


class _AccelerometerTable(FileModel):
    name: Name
    mass_kg: Annotated[float, Field(gt=0.0, le=1.0)]
    range_m_s2: Above
    noise_m_s2_per_sqrt_hz: Above


class _SensorsFile(FileModel):
    format: Literal["armodal-sensors-1"]
    hammers: Annotated[list[_HammerTable], Field(min_length=1, max_length=64)]
    accelerometers: Annotated[list[_AccelerometerTable], Field(min_length=1, max_length=64)]


# Sizes in which impact hammers and triaxial accelerometers are sold; to be replaced by one's own.
CATALOGUE = Equipment(
    source="sizes that are sold; give your own with --sensors",
    hammers=(
        Hammer(name="small hammer", head_kg=0.10, range_n=440.0),
        Hammer(name="medium hammer", head_kg=0.16, range_n=2200.0),
        Hammer(name="large hammer", head_kg=0.32, range_n=22000.0),
        Hammer(name="sledge hammer", head_kg=1.1, range_n=22000.0),
    ),
    accelerometers=(
        Accelerometer(name="sensitive, 5 g", mass_kg=0.025, range_m_s2=49.0, noise=1.0e-4),
        Accelerometer(name="general, 50 g", mass_kg=0.0075, range_m_s2=490.0, noise=5.0e-4),
        Accelerometer(name="small, 500 g", mass_kg=0.004, range_m_s2=4900.0, noise=5.0e-3),
    ),
)


def load_equipment(path: Path) -> Equipment:
    """Read a laboratory's list of sensors.

    Raises
    ------
    PlanError
        If it cannot be read, or a value is not possible; the message has the key's path.
    """
    text = read_text(path, what="sensors file", limit_bytes=_LIMIT, error=PlanError)
    origin = f"sensors file {path.name}"
    file = validate(
        _SensorsFile,
        parse_toml(text, origin=origin, error=PlanError),
        origin=origin,
        error=PlanError,
    )
    return Equipment(
        source=path.name,
        hammers=tuple(
            Hammer(name=table.name, head_kg=table.head_kg, range_n=table.range_n)
            for table in file.hammers
        ),
        accelerometers=tuple(
            Accelerometer(
                name=table.name,
                mass_kg=table.mass_kg,
                range_m_s2=table.range_m_s2,
                noise=table.noise_m_s2_per_sqrt_hz,
            )
            for table in file.accelerometers
        ),
    )
