"""Read the figures that link inertias have to meet, and what is believed of the links.

The format is specified in `docs/inertia-targets-file.md`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError
from armodal.protocols.toml_reader import (
    FileModel,
    Name,
    not_wanted,
    parse_toml,
    read_text,
    refuse,
    validate,
)

__all__ = [
    "BaseTable",
    "InertiaTargetsFile",
    "LinkBelief",
    "ModesTable",
    "MomentTable",
    "TotalMassTable",
    "ZeroTable",
    "load_inertia_targets",
]


_LIMIT = 256 * 1024

Positive = Annotated[float, Field(gt=0.0, lt=1e9)]
Share = Annotated[float, Field(gt=0.0, lt=1.0)]
Relative = Annotated[float, Field(gt=0.0, le=1.0)]
Source = Annotated[str, Field(min_length=1, max_length=400)]
Length = Annotated[float, Field(ge=-100.0, le=100.0)]
AngleDeg = Annotated[float, Field(ge=-3600.0, le=3600.0)]
PostureDeg = Annotated[list[AngleDeg], Field(min_length=1, max_length=32)]


class TotalMassTable(FileModel):
    """Mass of the whole arm, base included."""

    value_kg: Positive
    margin_kg: Positive
    source: Source


class BaseTable(FileModel):
    """The part that does not move: only its share of the mass counts."""

    volume_share: Share


class LinkBelief(FileModel):
    """A moving link as believed: share of the volume, and the box it fills, in its own frame."""

    name: Name
    volume_share: Share
    center_m: Annotated[list[Length], Field(min_length=3, max_length=3)]
    box_m: Annotated[
        list[Annotated[float, Field(gt=0.0, le=10.0)]], Field(min_length=3, max_length=3)
    ]
    source: Source


class PostureFigure(FileModel):
    """A figure that holds in one posture."""

    posture_deg: PostureDeg
    source: Source


class MomentTable(PostureFigure):
    """Moment of inertia about a joint in a posture."""

    joint: Name
    value_kg_m2: Positive
    margin_kg_m2: Positive


class ZeroTable(PostureFigure):
    """Angle at which the coupling of two joints in the mass matrix vanishes."""

    joints: Annotated[list[Name], Field(min_length=2, max_length=2)]
    swept: Name
    margin_deg: Positive


class ModesTable(PostureFigure):
    """Frequencies and damping of the first modes in a posture."""

    f_hz: Annotated[list[Positive], Field(min_length=1, max_length=32)]
    f_margin_hz: Positive
    damping_percent: Annotated[list[Positive], Field(max_length=32)] = Field(default=[])
    damping_margin_percent: Positive | None = None

    @model_validator(mode="after")
    def _check_damping(self) -> ModesTable:
        if self.damping_percent and len(self.damping_percent) != len(self.f_hz):
            raise not_wanted("as many values in damping_percent as in f_hz, or none")
        if bool(self.damping_percent) != (self.damping_margin_percent is not None):
            raise not_wanted("damping_percent and damping_margin_percent together, or neither")
        return self


class InertiaTargetsFile(FileModel):
    """The whole file."""

    format: Literal["armodal-inertia-targets-1"]
    arm: Name
    source: Source
    mass_std: Relative  # of a link's share of the mass
    center_std: Relative  # of a centre, in parts of the box
    spread_std: Relative  # of the logarithm of the mass's spread
    total_mass: TotalMassTable
    base: BaseTable
    links: Annotated[list[LinkBelief], Field(min_length=1, max_length=32)]
    moments: Annotated[list[MomentTable], Field(max_length=1000)] = Field(default=[])
    zeros: Annotated[list[ZeroTable], Field(max_length=1000)] = Field(default=[])
    modes: Annotated[list[ModesTable], Field(max_length=1000)] = Field(default=[])

    @model_validator(mode="after")
    def _check_shares(self) -> InertiaTargetsFile:
        total = self.base.volume_share + sum(link.volume_share for link in self.links)
        # Shares are written with two or three decimals.
        if not math.isclose(total, 1.0, abs_tol=0.01):
            raise not_wanted(f"volume shares of base and links that sum to 1 (these make {total})")
        return self


def load_inertia_targets(path: Path, arm: Arm) -> InertiaTargetsFile:
    """Read a targets file and check it against the arm it is for.

    Raises
    ------
    ArmError
        If the file cannot be read, or a value is not possible; the message has the key's path.
    """
    text = read_text(path, what="inertia targets file", limit_bytes=_LIMIT, error=ArmError)
    origin = f"inertia targets file {path.name}"
    file = validate(
        InertiaTargetsFile,
        parse_toml(text, origin=origin, error=ArmError),
        origin=origin,
        error=ArmError,
    )
    if file.arm != arm.name:
        refuse(ArmError, origin, "arm", wanted=f"the arm at hand, {arm.name}", got=file.arm)
    links = [joint.link.name for joint in arm.joints]
    if [link.name for link in file.links] != links:
        wanted = f"the moving links from the base outwards, {', '.join(links)}"
        refuse(ArmError, origin, "links", wanted=wanted, got=[link.name for link in file.links])
    joints = [joint.name for joint in arm.joints]
    wanted = f"one of the joints {', '.join(joints)}"
    for i, moment in enumerate(file.moments):
        if moment.joint not in joints:
            refuse(ArmError, origin, f"moments[{i}].joint", wanted=wanted, got=moment.joint)
    for i, zero in enumerate(file.zeros):
        for name in (*zero.joints, zero.swept):
            if name not in joints:
                refuse(ArmError, origin, f"zeros[{i}]", wanted=wanted, got=name)
    figures: dict[str, Sequence[PostureFigure]] = {
        "moments": file.moments,
        "zeros": file.zeros,
        "modes": file.modes,
    }
    for key, tables in figures.items():
        for i, table in enumerate(tables):
            if len(table.posture_deg) != len(joints):
                text = f"{len(joints)} angles, one per joint"
                path_to = f"{key}[{i}].posture_deg"
                refuse(ArmError, origin, path_to, wanted=text, got=table.posture_deg)
    elastic = sum(joint.stiffness is not None for joint in arm.joints)
    for i, modes in enumerate(file.modes):
        if len(modes.f_hz) > elastic:
            text = f"at most {elastic} modes, one per joint with a stiffness"
            refuse(ArmError, origin, f"modes[{i}].f_hz", wanted=text, got=modes.f_hz)
    return file
