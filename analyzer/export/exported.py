"""An arm file as a simulator's: from the effects to text, with what to know of it."""

from __future__ import annotations

from dataclasses import dataclass

from armodal.analyzer.corrected.chain import chain_of
from armodal.analyzer.corrected.correction import Correction, correction_of
from armodal.analyzer.export.losses import as_dampers
from armodal.analyzer.export.tree import Tree, tree_of
from armodal.protocols.arm.records import Arm

__all__ = ["BELOW_HZ", "Ready", "ready_for_export"]

_HEARD_HZ = 200.0  # modes for which dampers take the place of loss factors
BELOW_HZ = 500.0  # modes compared; higher ones are of what gives way next to nothing


@dataclass(frozen=True, slots=True, kw_only=True)
class Ready:
    """Bodies and springs of an arm, and what was approximated."""

    correction: Correction
    tree: Tree
    notes: tuple[str, ...]


def ready_for_export(arm: Arm, *, level: float = 0.0) -> Ready:
    """Return what every simulator's format is written from.

    Parameters
    ----------
    level
        ln of the hits' peak force over the middle of the test's, for laws of amplitude.

    Raises
    ------
    ArmError
        If an effect has no counterpart in a simulator; all are named.
    """
    correction = correction_of(arm)
    chain = chain_of(correction, level=level)
    notes = list(correction.notes)
    if chain.loss.any():
        found = as_dampers(correction, chain, below_hz=_HEARD_HZ)
        chain = found.chain
        notes.append(
            f"loss factors are dampers that take as much at {found.at_hz:.0f} Hz: in 20 postures, "
            f"to {_HEARD_HZ:.0f} Hz, "
            f"frequencies differ by at most {100 * found.f_error:.2f} %, damping ratios by "
            f"{100 * found.damping_error:.2f} points of a hundred"
        )
    level_dependent = [i.title for i in correction.hypothesis.instances if i.level_dependent]
    if level_dependent:
        notes.append(
            f"linear springs at one level of motion instead of: {'; '.join(level_dependent)}"
        )
    if chain.offset_rad.any():
        moved = [
            f"{joint.name} {offset:+.5f} rad"
            for joint, offset in zip(arm.joints, chain.offset_rad, strict=True)
            if offset
        ]
        notes.append(
            "a simulator's joint angle is where the joint stands, which is what the encoder reads "
            f"and {', '.join(moved)}"
        )
    return Ready(correction=correction, tree=tree_of(arm, chain), notes=tuple(notes))
