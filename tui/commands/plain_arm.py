"""An arm for calculations that know only its links and joints."""

from __future__ import annotations

from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["plain_arm"]


def plain_arm(source: str) -> Arm:
    """Load an arm for a calculation that knows only its links and joints.

    Raises
    ------
    ArmError
        If it has effects; all are named.
    """
    arm = load_arm(source)
    if arm.effects:
        named = ", ".join(f"{effect.name} ({effect.place})" for effect in arm.effects)
        raise ArmError(
            f"arm '{arm.name}': wanted links and joints alone, which is what this command plans "
            f"for, got the effects {named}; give the arm file without its [[effects]]. The next "
            "test of a corrected arm is proposed by `armodal gap --arm`"
        )
    return arm
