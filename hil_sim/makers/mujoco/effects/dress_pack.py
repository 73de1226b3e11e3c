"""A hose that stands off a link and sways: rigid pieces in a row, each hinged both ways."""

import numpy as np

from armodal.hil_sim.makers.arm_table import Inertial
from armodal.hil_sim.makers.mujoco.machine import Axis, Body
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig
from armodal.hil_sim.makers.shell_points import along

OUTSIDE = True  # a gap analysis has no name for it
SPAN = (0.001, 0.25)  # of the arm's mass
PIECES = 3
LENGTH_M = (0.2, 0.5)
OWN_HZ = (6.0, 28.0)
LOSS_TIME_S = (5e-4, 4e-3)
CLAMPED = 1.8751**2  # of a clamped beam: omega_1 = CLAMPED sqrt(EI / (m L^3)), Blevins (1979)
THICK = 0.1  # radius of gyration about its line, of a piece's length


def places(drawn: Ordinary) -> list[str]:
    """A link from the second on."""
    return [row.link for row in drawn.table.links[1:]]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Clamp it to the shell, in a drawn direction."""
    rng, row = rig.rng, rig.row(place)
    mass = size * sum(body.mass_kg for body in rig.drawn.table.inertials())
    length = float(rng.uniform(*LENGTH_M))
    omega = 2.0 * np.pi * float(np.exp(rng.uniform(*np.log(OWN_HZ))))
    loss = float(np.exp(rng.uniform(*np.log(LOSS_TIME_S))))
    start, line = along(row.shell, float(rng.uniform(0.2, 0.9)))[0], rig.direction()
    piece, own = length / PIECES, mass / PIECES
    stiffness = mass * length**3 * (omega / CLAMPED) ** 2 / piece
    about = np.outer(line, line)
    inertia = own * piece**2 * ((np.eye(3) - about) / 12.0 + THICK**2 * about)
    ways = np.linalg.svd(line[None, :])[2][1:]
    for i in range(PIECES):
        hinge, name = start + i * piece * line, f"hose {i + 1}"
        rig.machine.bodies[name] = Body(
            name=name,
            parent=f"hose {i}" if i else place,
            T_parent_body=np.eye(4),
            inertial=Inertial.of(own, hinge + 0.5 * piece * line, inertia),
            axes=[
                Axis(
                    name=f"{name} {j + 1}",
                    direction=way,
                    at_m=hinge,
                    stiffness=stiffness,
                    damping=loss * stiffness,
                )
                for j, way in enumerate(ways)
            ],
        )
    return {"mass_kg": mass, "length_m": length, "frequency_hz": omega / (2.0 * np.pi)}
