"""What any arm's laboratory is made of, as one process hands it to the other."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from armodal.protocols.arm.files import arm_from_texts
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlantError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.plan_records import Plan

__all__ = ["Rehearsal", "read_rehearsal", "write_rehearsal"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rehearsal:
    """What a laboratory is made of.

    Attributes
    ----------
    arm, plan
        As the user has them; without a plan the hand hits as the arm's size and the sensor's range
        allow.
    hidden
        Effect and size of each that the arm file knows nothing of. The size is that of
        `hil_sim.study`: "clear", "medium", "faint", or times clear.
    """

    arm: Arm
    plan: Plan | None = None
    hidden: tuple[tuple[str, str | float], ...] = field(default=())


class _Bundle(BaseModel):
    """Texts of a rehearsal, as one process hands them to the other."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    arm: str
    urdf: str | None
    database: str | None
    plan: str | None
    hidden: Annotated[tuple[tuple[str, str | float], ...], Field(strict=False)]


def write_rehearsal(rehearsal: Rehearsal, path: Path) -> None:
    """Write arm, plan and wish for a laboratory's process to read; nothing of the truth."""
    arm, plan = rehearsal.arm, rehearsal.plan
    bundle = _Bundle(
        arm=arm.text,
        urdf=arm.urdf_text,
        database=None if arm.can is None else arm.can.database_text,
        plan=None if plan is None else plan.text,
        hidden=rehearsal.hidden,
    )
    path.write_text(bundle.model_dump_json(), encoding="utf-8")


def read_rehearsal(path: Path) -> Rehearsal:
    """Read what `write_rehearsal` wrote.

    Raises
    ------
    ArmodalError
        If the file is missing or not such a one, or arm or plan cannot be used.
    """
    try:
        bundle = _Bundle.model_validate_json(path.read_text(encoding="utf-8"))
    except (OSError, ValidationError, UnicodeDecodeError) as error:
        raise PlantError(
            f"{path}: wanted arm and plan as armodal sim hands them over, got something else; "
            "start the laboratory with armodal sim --arm"
        ) from error
    arm = arm_from_texts(bundle.arm, urdf_text=bundle.urdf, database_text=bundle.database)
    plan = None if bundle.plan is None else plan_from_text(bundle.plan, arm)
    return Rehearsal(arm=arm, plan=plan, hidden=bundle.hidden)
