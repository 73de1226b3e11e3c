"""What results say of joint angles that a person has told."""

from __future__ import annotations

import math

from armodal.protocols.session.records import SessionHeader

__all__ = ["angles_by_hand"]


def angles_by_hand(header: SessionHeader) -> tuple[str, ...]:
    """Return the sentence that every result of such a session carries; none for measured angles."""
    told_rad = header.told_tolerance_rad
    if told_rad is None:
        return ()
    return (
        (
            f"joint angles were told by the operator, to {math.degrees(told_rad):g} deg, and "
            "nobody measured them: an arm that stood elsewhere, or moved, would not show"
        ),
    )
