"""The `[[effects]]` of an arm file: what a gap analysis named, with what it stands on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import datetime
from typing import Annotated

from pydantic import Field, field_validator, model_validator

from armodal.protocols.arm.records import AddedEffect, EffectEvidence, EffectParameter
from armodal.protocols.errors import ArmError
from armodal.protocols.toml_reader import FileModel, Name, not_wanted, refuse

__all__ = ["EffectTable", "PastSessionTable", "added_effect"]

# How far from unit length a direction may be written: three decimals.
_DIRECTION = 2e-3

Words = Annotated[str, Field(min_length=1, max_length=400)]
Finite = Annotated[float, Field(gt=-1e15, lt=1e15)]
Key = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,63}$")]
Numbers = Annotated[list[Finite], Field(min_length=1, max_length=16)]


Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
CreatedText = Annotated[str, Field(max_length=40)]


def _with_zone(value: str) -> str:
    try:
        known = datetime.fromisoformat(value).tzinfo is not None
    except ValueError:
        known = False
    if not known:
        raise not_wanted("an ISO 8601 time with its zone, such as 2026-01-31T12:00:00+00:00")
    return value


class ParameterTable(FileModel):
    """A parameter with one standard deviation and its 95 % interval."""

    unit: Annotated[str, Field(max_length=24)] = ""
    value: Finite
    std: Annotated[float, Field(ge=0.0, lt=1e15)]
    low: Finite
    high: Finite

    @model_validator(mode="after")
    def _check_order(self) -> ParameterTable:
        if not self.low <= self.value <= self.high:
            raise not_wanted("low <= value <= high")
        return self


class EvidenceTable(FileModel):
    """What the name stands on."""

    gain_nats: Finite | None = None
    held_out_gain_nats: Finite | None = None
    confidence: Annotated[float, Field(ge=0.0, le=1.0)] | None = None
    session_sha256: Sha256
    created: CreatedText

    _check_time = field_validator("created")(_with_zone)


class PastSessionTable(FileModel):
    """A session that changed the file."""

    session_sha256: Sha256
    by: Annotated[str, Field(min_length=1, max_length=60)]
    created: CreatedText

    _check_time = field_validator("created")(_with_zone)


class EffectTable(FileModel):
    """One effect."""

    name: Name
    place: Name
    parameters: Annotated[dict[Name, ParameterTable], Field(max_length=64)]
    description: Annotated[dict[Key, Words | Finite | Numbers], Field(max_length=32)] = Field(
        default={}
    )
    evidence: EvidenceTable

    @field_validator("description")
    @classmethod
    def _check_geometry(
        cls, value: dict[str, str | float | list[float]]
    ) -> dict[str, str | float | list[float]]:
        for key in ("direction", "point_m"):
            found = value.get(key)
            if found is not None and not (isinstance(found, list) and len(found) == 3):
                raise not_wanted(f"{key} of three numbers")
        direction = value.get("direction")
        if isinstance(direction, list) and abs(math.hypot(*direction) - 1.0) > _DIRECTION:
            raise not_wanted(f"direction of length 1 (this one has {math.hypot(*direction):.4g})")
        if not isinstance(value.get("link", ""), str):
            raise not_wanted("link as a link's name")
        return value


def added_effect(
    table: EffectTable, *, path: str, links: Sequence[str], origin: str
) -> AddedEffect:
    """Return the record of a table whose link is one of the arm's.

    Raises
    ------
    ArmError
        If `description.link` is no link of the arm.
    """
    link = table.description.get("link")
    if link is not None and link not in links:
        wanted = f"one of the links {', '.join(links)}"
        refuse(ArmError, origin, f"{path}.description.link", wanted=wanted, got=link)
    e = table.evidence
    return AddedEffect(
        name=table.name,
        place=table.place,
        parameters=tuple(
            EffectParameter(
                name=name, unit=p.unit, value=p.value, std=p.std, low=p.low, high=p.high
            )
            for name, p in table.parameters.items()
        ),
        description={
            key: tuple(value) if isinstance(value, list) else value
            for key, value in table.description.items()
        },
        evidence=EffectEvidence(
            gain_nats=e.gain_nats,
            held_out_gain_nats=e.held_out_gain_nats,
            confidence=e.confidence,
            session_sha256=e.session_sha256,
            created=e.created,
        ),
    )
