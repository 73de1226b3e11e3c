"""What the laws of joints in an arm file have in common.

The file counts a law by the swing of a hit of the middle level (`docs/theory-gap.md`).
"""

from __future__ import annotations

from armodal.hil_sim.effects.from_file import FileEffect, Unlike

__all__ = ["spring_of", "swing_of"]


def spring_of(own: FileEffect) -> float:
    """Stiffness of the joint in the file."""
    if own.joint.stiffness is None:
        raise Unlike("law at a rigid joint")
    return own.joint.stiffness.value


def swing_of(own: FileEffect) -> float:
    """Turn of a hit of the middle level, in rad."""
    swing = own.effect.description.get("swing_rad")
    if not isinstance(swing, float):
        raise Unlike("a joint's law without its swing; fit the session again")
    return swing
