"""The next test that the gap workflow proposes: a plan file, and what it is measured with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from armodal.hil_sim.board_id import BOARD_ID
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlanError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.records import Session
from armodal.protocols.text_file import write_new_text

__all__ = ["NextRun", "keep_plan", "next_run", "next_test_of", "next_test_plan"]


@dataclass(frozen=True, slots=True, kw_only=True)
class NextRun:
    """What the session of the next test is begun with."""

    plan: Path
    arm: Arm  # as the session in review has it
    simulated: bool

    @property
    def journal(self) -> Path:
        """The journal of its session, beside the plan."""
        return self.plan.with_suffix(".journal")


def next_run(session: Session, plan: Path) -> NextRun:
    """Return how the next test is measured: in the simulated laboratory if the session was."""
    header = session.header
    return NextRun(plan=plan, arm=header.arm, simulated=header.dictionary.board_id == BOARD_ID)


def keep_plan(text: str, path: Path) -> None:
    """Write a plan, unless it is there already; another one stays as it is.

    Raises
    ------
    PlanError
        If there is another file, or it cannot be written.
    """
    try:
        there = path.read_text(encoding="utf-8") if path.exists() else None
    except (OSError, UnicodeDecodeError):
        there = ""
    if there is None:
        write_new_text(path, text, error=PlanError)
    elif there != text:
        raise PlanError(f"{path} is there already and stays as it is; move it away first")


def next_test_of(found: Mapping[str, Any] | None) -> Mapping[str, Any] | None:
    """Return the next test of the object `armodal gap --json` prints; None where it has none."""
    test = None if found is None else found.get("next_test")
    return test if isinstance(test, Mapping) else None


def next_test_plan(session: Session, found: Mapping[str, Any] | None) -> str:
    """Return the text of the proposed plan, read once as `armodal run` will read it.

    Raises
    ------
    PlanError
        If no test is proposed, or it is no plan for the arm of the session.
    """
    test = next_test_of(found)
    text = None if test is None else test.get("plan_toml")
    if not isinstance(text, str) or not text.strip():
        raise PlanError(
            "wanted a next test in the gap result, it proposes none; nothing was written"
        )
    plan_from_text(text, session.header.arm, origin="proposed next test")
    return text
