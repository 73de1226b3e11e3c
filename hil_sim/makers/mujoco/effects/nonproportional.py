"""A dashpot between the floor and a link: loss where no joint turns alone."""

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import Spring
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig
from armodal.hil_sim.makers.shell_points import along

SPAN = (0.01, 20.0)  # of the first drive's damping over the square of a metre


def places(drawn: Ordinary) -> list[str]:
    """From the floor to the third link, or one beyond."""
    return [f"floor|{row.link}" for row in drawn.table.links[2:4]]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Span the dashpot from a place on the floor."""
    row = rig.row(place.split("|")[1])
    end = along(row.shell, float(rig.rng.uniform(0.2, 0.9)))[0]
    reach = sum(float(np.linalg.norm(r.xyz_m)) for r in rig.drawn.table.links)
    floor = rig.rng.uniform(-0.55, 0.55, 3) * np.array([reach, reach, 0.0])
    damping = size * rig.drive(rig.drawn.elastic[0]).damping
    rig.machine.springs.append(
        Spring(name="dashpot", ends=(("", floor), (row.link, end)), damping=damping)
    )
    return {"damping_n_s_per_m": damping, "from_m": floor.tolist(), "to_m": end.tolist()}
