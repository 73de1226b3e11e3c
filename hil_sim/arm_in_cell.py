"""The plant with its sensors and its hand, as the laboratory's process wants them."""

from __future__ import annotations

from hil_sim.lab_process import ArmInCell
from hil_sim.plant import Plant

__all__ = ["arm_in_cell"]


def arm_in_cell(plant: Plant, *, seed: int) -> ArmInCell[object]:
    """Put the arm with its sensors into the cell."""
    raise NotImplementedError((plant, seed))
