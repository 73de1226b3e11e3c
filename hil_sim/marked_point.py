"""The arm with a test point marked elsewhere on its link."""

from __future__ import annotations

from pydantic import ValidationError

from armodal.hil_sim.operator import Marking
from armodal.hil_sim.plant import Plant, build_plant
from armodal.hil_sim.plant_file import PlantFile
from armodal.protocols.errors import PlantError

__all__ = ["with_point"]


def with_point(plant: Plant, point_id: str, marking: Marking) -> Plant:
    """Return the same arm with a point elsewhere, on whatever piece of its link carries it there.

    Raises
    ------
    PlantError
        If the arm has no such point, or cannot carry it there.
    """
    plant.point(point_id)
    tables = plant.truth.model_dump(by_alias=True)
    for point in tables["points"]:
        if point["id"] == point_id:
            point |= {
                "position_m": marking.position_m,
                "normal": marking.normal,
                "x_axis": marking.x_axis,
            }
    try:
        return build_plant(PlantFile.model_validate(tables))
    except ValidationError as error:
        told = "; ".join(fault["msg"] for fault in error.errors())
        raise PlantError(f"point {point_id} cannot be marked there: {told}") from error
