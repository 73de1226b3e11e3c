"""The plant with its sensors and its hand, as the laboratory's process wants them."""

from __future__ import annotations

from hil_sim.lab_process import ArmInCell
from hil_sim.plant import Plant
from protocols.errors import PlantError

__all__ = ["arm_in_cell"]


def arm_in_cell(plant: Plant, *, seed: int) -> ArmInCell[object]:
    """Put the arm with its sensors into the cell.

    Raises
    ------
    PlantError
        Always: the sensors and the hand that the plant file describes are not simulated here.
    """
    raise PlantError(
        f"{plant.truth.name}, seed {seed}: wanted the plant's sensors and hand (hil_sim.source), "
        "which this version does not have; run a laboratory around a source of your own by "
        "hil_sim.lab_process.LabProcess"
    )
