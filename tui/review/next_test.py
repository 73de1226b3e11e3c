"""The next test that the gap workflow proposes, as a plan file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from protocols.errors import PlanError
from protocols.plan import plan_from_text
from protocols.session.records import Session

__all__ = ["next_test_of", "next_test_plan"]


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
