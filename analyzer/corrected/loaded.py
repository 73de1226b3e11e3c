"""An arm whose effects are bodies on its links, for calculations of links and joints alone."""

from __future__ import annotations

from dataclasses import dataclass, replace

from armodal.analyzer.corrected.correction import correction_of
from armodal.analyzer.corrected.held import held_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["LoadedArm", "loaded_arm"]


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadedArm:
    """An arm without effects: what they put on its links is part of the links."""

    arm: Arm
    notes: tuple[str, ...]


def loaded_arm(arm: Arm) -> LoadedArm:
    """Put the bodies of an arm's effects into its links.

    Raises
    ------
    ArmError
        If an effect of the arm is more than a body on a link; all such are named.
    """
    if not arm.effects:
        return LoadedArm(arm=arm, notes=())
    correction = correction_of(arm)
    refused = [
        f"{effect.name} ({effect.place})"
        for effect in arm.effects
        if not _is_load(replace(arm, effects=(effect,)))
    ]
    if refused:
        raise ArmError(
            f"arm '{arm.name}': wanted links, what they carry, and joints, which is what this "
            f"command plans for, got the effects {', '.join(refused)}; give the arm file without "
            "them. The next test of a corrected arm is proposed by `armodal gap --arm`"
        )
    return LoadedArm(
        arm=replace(held_arm(arm).arm, effects=()),
        notes=(
            *(
                f"computed with the mass and inertia of: {title}; the room it takes is not known"
                for title in correction.titles
            ),
            *correction.notes,
        ),
    )


def _is_load(arm: Arm) -> bool:
    """Whether an arm's one effect changes links' bodies alone, or is of the test."""
    if not correction_of(arm).hypothesis.instances:
        return True
    try:
        ready = held_arm(arm)
    except ArmError:
        return False
    held = ready.held
    return not ready.axes and (
        held is None
        or not (held.names or held.mass.any() or held.damping.any() or held.stiffness.any())
    )
