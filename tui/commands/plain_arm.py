"""An arm for calculations that know only its links and joints."""

from __future__ import annotations

from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.tui.console import err

__all__ = ["plain_arm"]


def plain_arm(source: str) -> Arm:
    """Load an arm for a calculation that knows only its links and joints, and say so."""
    arm = load_arm(source)
    for note in arm.effects_left_out():
        err.print(f"note: {note}")
    return arm
