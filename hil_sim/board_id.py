"""What the simulated board calls itself."""

from __future__ import annotations

__all__ = ["BOARD_ID"]

BOARD_ID = "armodal-sim"
