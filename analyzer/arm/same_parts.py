"""Whether two arm files are of one arm, as it was measured: beliefs may differ, parts may not."""

from __future__ import annotations

import numpy as np

from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["check_same_parts"]

_SAME_POINT_M = 1e-6  # positions are copied, not measured again


def check_same_parts(measured: Arm, other: Arm) -> None:
    """Refuse another arm than was measured.

    Raises
    ------
    ArmError
        If joints, links or points are not the same ones.
    """
    for what, wanted, came in (
        ("joints", [j.name for j in measured.joints], [j.name for j in other.joints]),
        ("links", [j.link.name for j in measured.joints], [j.link.name for j in other.joints]),
        ("points", [p.id for p in measured.points], [p.id for p in other.points]),
    ):
        if wanted != came:
            raise ArmError(
                f"arm '{other.name}' does not match the session: wanted the {what} "
                f"{', '.join(wanted)}, got {', '.join(came)}; give the measured arm"
            )
    for was, now in zip(measured.points, other.points, strict=True):
        moved = float(np.linalg.norm(was.position_m - now.position_m))
        if now.link != was.link or moved > _SAME_POINT_M:
            raise ArmError(
                f"arm '{other.name}': point '{now.id}' is not where the session measured it "
                f"({1e3 * moved:.0f} mm off, link '{now.link}' instead of '{was.link}'); "
                "give an arm with the session's points"
            )
