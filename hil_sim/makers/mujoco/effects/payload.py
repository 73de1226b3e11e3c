"""A body on a link that nobody told of: its mass, centre and inertia are its own."""

import numpy as np

from armodal.hil_sim.makers.arm_table import Inertial
from armodal.hil_sim.makers.mujoco.machine import Body
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig
from armodal.hil_sim.makers.shell_points import along

SPAN = (0.002, 0.4)  # of the arm's mass
SIDES_M = (0.03, 0.28)  # of a box of even density


def places(drawn: Ordinary) -> list[str]:
    """On the flange, or on a link beyond the second joint."""
    rows = drawn.table.links
    return [rows[-1].link, rows[-1].link, *(row.link for row in rows[2:-1])]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Bolt on a box of a mass of `size` times the arm's."""
    rows, row = rig.drawn.table.links, rig.row(place)
    mass = size * sum(body.mass_kg for body in rig.drawn.table.inertials())
    at, _ = along(row.shell, 1.0 if row is rows[-1] else float(rig.rng.uniform(0.4, 0.9)))
    sides = rig.rng.uniform(*SIDES_M, 3)
    center = at + rig.direction() * (0.5 * row.shell.diameter_m + 0.3 * float(np.max(sides)))
    inertia = mass / 12.0 * np.diag(np.sum(sides**2) - sides**2)
    turn = np.linalg.qr(rig.rng.standard_normal((3, 3)))[0]
    body = Inertial.of(mass, center, turn @ inertia @ turn.T)
    rig.machine.bodies["payload"] = Body(
        name="payload", parent=place, T_parent_body=np.eye(4), inertial=body
    )
    return {
        "mass_kg": mass,
        "center_m": center.tolist(),
        "inertia_kg_m2": body.matrix().tolist(),
        "radius_of_gyration_m": float(np.sqrt(np.trace(body.matrix()) / 3.0 / mass)),
    }
