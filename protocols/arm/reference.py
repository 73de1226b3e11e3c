"""Where an arm file's stiffness is meant, if a part loses alike at all frequencies."""

from __future__ import annotations

__all__ = ["STIFFNESS_AT_HZ"]

STIFFNESS_AT_HZ = 30.0  # a definition of the file: such a part is stiffer the faster it moves
