"""Where a session is kept: its journal, and what an earlier run left in it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import PlanError, SessionError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.plan_records import Plan
from armodal.protocols.session.journal import Journal, Mark, read_journal
from armodal.protocols.session.records import Hit

__all__ = ["SessionPlace", "find_place", "with_trigger_level"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionPlace:
    """The journal's path, the arm and plan it goes by, and what is already in it."""

    journal: Path
    arm: Arm
    plan: Plan
    begun: bool
    hits: tuple[Hit, ...] = ()
    marks: tuple[Mark, ...] = ()
    ended: str | None = None  # the last word in the journal; None while it was never closed

    @property
    def session_file(self) -> Path:
        """The session file derived from the journal."""
        return self.journal.with_suffix(".h5")


def find_place(journal: Path, arm: Arm, plan: Plan | None) -> SessionPlace:
    """Return a place to begin a session, or to go on with the one that is there.

    A session that was begun goes by the arm and plan kept in its journal.

    Raises
    ------
    SessionError
        If the journal belongs to another plan than the one asked for, or there is neither a
        journal nor a plan.
    JournalError
        If there is a journal and it cannot be read.
    """
    if not journal.exists():
        if plan is None:
            raise SessionError(
                f"{journal} is not there yet: give a plan to begin a session with, as armodal run "
                "rv4frl-three-postures"
            )
        return SessionPlace(journal=journal, arm=arm, plan=plan, begun=False)
    earlier: Journal = read_journal(journal)
    theirs = earlier.header.plan
    if plan is not None and plan.name != theirs.name:
        raise SessionError(
            f"{journal} is a session of plan {theirs.name}, not of {plan.name}: leave the plan "
            "out to go on with it, or give another file with --session"
        )
    return SessionPlace(
        journal=journal,
        arm=earlier.header.arm,
        plan=theirs,
        begun=True,
        hits=earlier.hits,
        marks=earlier.marks,
        ended=earlier.end.reason if earlier.end else None,
    )


def with_trigger_level(plan: Plan, arm: Arm, level_n: float) -> Plan:
    """Return the plan with another trigger level, in its text too, so that the journal keeps it.

    Raises
    ------
    PlanError
        If the plan's text has no such key where it must be, or the level is no level.
    """
    told = f"{level_n:.3g}"
    for found in re.finditer(r"\blevel_n\s*=\s*([-+0-9.eE_]+)", plan.text):
        text = plan.text[: found.start(1)] + told + plan.text[found.end(1) :]
        changed = plan_from_text(text, arm, origin=f"plan {plan.name}")
        if changed.trigger.level_n == float(told):  # else it stands in a comment
            return changed
    raise PlanError(f"plan {plan.name}: wanted level_n = ... of the trigger in its text, got none")
