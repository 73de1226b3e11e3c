"""The import manifest: which foreign files are which posture of which arm.

The format is specified in `docs/exchange.md`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, field_validator

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.measured import Cut, Hints, parse_dof
from armodal.protocols.foreign.units import SI
from armodal.protocols.frf_records import FrfForm
from armodal.protocols.plan_model import AveragingTable, WindowsTable
from armodal.protocols.toml_reader import (
    FileModel,
    Name,
    Vector3,
    not_wanted,
    parse_toml,
    read_text,
    validate,
)

__all__ = [
    "FILL_IN",
    "MOST_AVERAGES",
    "NO_ARM",
    "FileTable",
    "Manifest",
    "ManifestFile",
    "PostureTable",
    "Reading",
    "load_manifest",
]

NO_ARM = "none"
MOST_AVERAGES = 1_000_000

_LIMIT = 512 * 1024
_UNIT_LENGTH = 1e-3  # a direction written with three decimals
_MOST_FILES = 10_000

PathText = Annotated[str, Field(min_length=1, max_length=4096, pattern=r"^[^\x00\n]*$")]
PointId = Annotated[str, Field(min_length=1, max_length=16)]
Dof = Annotated[str, Field(min_length=1, max_length=20)]
Form = Literal["receptance", "mobility", "accelerance"]
Kind = Literal["frf", "hit"]
RoleName = Literal[
    "time", "frequency", "frf", "real", "imaginary", "magnitude", "phase", "coherence", "force",
    "response",
]  # fmt: skip
VariableName = Annotated[str, Field(min_length=1, max_length=200)]
Factor = Annotated[float, Field(ge=-1e12, le=1e12)]
FILL_IN = "?"  # stands where only a person knows


class UnitsTable(FileModel):
    """Units of response and force where the files are silent or wrong."""

    response: Annotated[str, Field(min_length=1, max_length=20)]
    force: Annotated[str, Field(min_length=1, max_length=20)]


Units = Literal["SI"] | UnitsTable


class ScaleTable(FileModel):
    """Factors to SI of a file whose numbers have no unit: N and m/s^2 per unit of the file."""

    force: Factor = 1.0
    response: Factor = 1.0


class CutTable(FileModel):
    """How a record of many hits is cut where the pulses do not tell it rightly."""

    record_s: Annotated[float, Field(gt=0.0, le=1e4)] | None = None
    pretrigger_s: Annotated[float, Field(gt=0.0, le=1e3)] | None = None
    level_n: Annotated[float, Field(gt=0.0, le=1e9)] | None = None
    apart_s: Annotated[float, Field(gt=0.0, le=1e3)] | None = None


class Reading(FileModel):
    """How a file is read: what it does not tell itself."""

    kind: Kind | None = None
    variables: dict[RoleName, VariableName | list[VariableName]] | None = None
    form: Form | None = None
    units: Units | None = None
    scale: ScaleTable | None = None
    rate_hz: Annotated[float, Field(gt=0.0, le=1e7)] | None = None
    first_line_hz: Annotated[float, Field(ge=0.0, le=1e6)] | None = None
    line_spacing_hz: Annotated[float, Field(gt=0.0, le=1e5)] | None = None
    cut: bool | CutTable | None = None


class FileTable(Reading):
    """A file with what holds for it alone."""

    path: PathText
    force: PathText | None = None
    responses: Annotated[list[Dof], Field(max_length=1000)] | None = None
    reference: Dof | None = None
    references: Annotated[list[Dof], Field(max_length=100)] | None = None


def _as_table(entry: Any) -> Any:
    return {"path": entry} if isinstance(entry, str) else entry


# A path alone is the table that holds nothing else.
FileEntry = Annotated[FileTable, BeforeValidator(_as_table)]


class PostureTable(FileModel):
    """One posture and the files measured there."""

    name: Name
    joints_deg: Annotated[list[float], Field(max_length=32)] = Field(default=[])
    files: Annotated[list[FileEntry], Field(min_length=1, max_length=_MOST_FILES)]
    averages: Annotated[int, Field(ge=1, le=MOST_AVERAGES)] | None = None
    hit_point: PointId | None = None
    hit_direction: Vector3 | None = None
    axes: Literal["base", "link"] | None = None
    window_decay_rad_s: Annotated[float, Field(ge=0.0, le=1e4)] | None = None
    validation: bool = False

    @field_validator("hit_direction")
    @classmethod
    def _check_direction(cls, value: list[float] | None) -> list[float] | None:
        if value is not None and abs(math.hypot(*value) - 1.0) > _UNIT_LENGTH:
            raise not_wanted(f"a vector of length 1 (this one has {math.hypot(*value):.4g})")
        return value


class ManifestFile(Reading):
    """The whole file; what it says of reading holds where a file's own entry says nothing."""

    format: Literal["armodal-import-1"] = "armodal-import-1"
    arm: PathText
    mode: Literal["roving-response", "roving-hammer"]
    axes: Literal["base", "link"] = "base"
    nodes: Annotated[dict[str, PointId], Field(max_length=10_000)] = Field(default={})
    links: Annotated[dict[str, Name], Field(max_length=10_000)] = Field(default={})
    sensor_mass_kg: Annotated[float, Field(ge=0.0, le=1.0)] | None = None
    windows: WindowsTable = WindowsTable()
    averaging: AveragingTable = AveragingTable()
    postures: Annotated[list[PostureTable], Field(min_length=1, max_length=100)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Manifest:
    """A manifest with the folder its paths start from."""

    file: ManifestFile
    text: str
    folder: Path
    origin: str

    def arm_source(self) -> str | Path:
        """Return a shipped arm's name, or the path of an arm file or URDF."""
        name = self.file.arm
        plain = "/" not in name and "\\" not in name
        if plain and Path(name).suffix.lower() not in {".toml", ".urdf"}:
            return name
        return self.folder / name

    def files(self, posture: PostureTable) -> list[tuple[Path, Hints]]:
        """Return each file of a posture with what the manifest says about it."""
        found = []
        for table in posture.files:
            hints = _hints(table, self.file, self.origin)
            force = None if table.force is None else self.folder / table.force
            found.append((self.folder / table.path, replace(hints, force_file=force)))
        return found


def _hints(table: FileTable, general: Reading, origin: str) -> Hints:
    def told(key: str) -> Any:
        own = getattr(table, key)
        return getattr(general, key) if own is None else own

    response, force = _unit_names(told("units"))
    form, scale, variables = told("form"), told("scale"), told("variables")
    references = table.references or ([table.reference] if table.reference else [])
    return Hints(
        form=None if form is None else FrfForm(form),
        response_unit=response,
        force_unit=force,
        responses=tuple(parse_dof(text, origin) for text in table.responses or ()),
        references=tuple(parse_dof(text, origin) for text in references),
        first_line_hz=told("first_line_hz"),
        line_spacing_hz=told("line_spacing_hz"),
        kind=told("kind"),
        variables={
            role: (names,) if isinstance(names, str) else tuple(names)
            for role, names in (variables or {}).items()
        },
        rate_hz=told("rate_hz"),
        force_scale=None if scale is None else scale.force,
        response_scale=None if scale is None else scale.response,
        cut=_cut(told("cut")),
    )


def _cut(told: bool | CutTable | None) -> Cut:
    if isinstance(told, CutTable):
        return Cut(**told.model_dump())
    return Cut(wanted=told is not False)


def _unit_names(units: Units | None) -> tuple[str | None, str | None]:
    if isinstance(units, UnitsTable):
        return units.response, units.force
    return (None, None) if units is None else (SI, SI)


def _to_fill_in(value: Any, path: str) -> Iterator[str]:
    """Yield the paths of the values that a person has still to fill in."""
    if value == FILL_IN:
        yield path
    elif isinstance(value, dict):
        for key, one in value.items():
            yield from _to_fill_in(one, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list):
        for i, one in enumerate(value):
            yield from _to_fill_in(one, f"{path}[{i}]")


def load_manifest(path: str | Path) -> Manifest:
    """Read an import manifest.

    Raises
    ------
    ForeignFileError
        If it cannot be read, or a value is not possible; the message has the key's path.
    """
    path = Path(path)
    text = read_text(path, what="manifest", limit_bytes=_LIMIT, error=ForeignFileError)
    origin = f"manifest {path.name}"
    data = parse_toml(text, origin=origin, error=ForeignFileError)
    open_keys = list(_to_fill_in(data, ""))
    if open_keys:
        raise ForeignFileError(
            f"{origin}: wanted every value, {', '.join(open_keys[:8])} still {FILL_IN!r}; fill in"
        )
    file = validate(ManifestFile, data, origin=origin, error=ForeignFileError)
    names = [posture.name for posture in file.postures]
    if len(set(names)) != len(names):
        raise ForeignFileError(f"{origin}: postures: wanted names that differ, got {names}")
    return Manifest(file=file, text=text, folder=path.parent, origin=origin)
