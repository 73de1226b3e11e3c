"""A hidden axis, askew in a link, about which its outer half gives way."""

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import Axis
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig
from armodal.hil_sim.makers.mujoco.split import outer_half

SPAN = (0.005, 2.0)  # its compliance over the arm's
ASIDE = 0.35  # of the shell's diameter, that the axis passes beside the middle line
LOSS_TIME_S = (2e-5, 4e-4)


def places(drawn: Ordinary) -> list[str]:
    """The second or third link."""
    return [row.link for row in drawn.table.links[1:3]]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Let the outer half turn about a drawn axis."""
    row = rig.row(place)
    outer, at, _ = outer_half(rig.machine, row)
    direction = rig.direction()
    point = at + ASIDE * row.shell.diameter_m * rig.rng.uniform(-1.0, 1.0, 3)
    stiffness, loss = 1.0 / (size * rig.compliance), float(rig.rng.uniform(*LOSS_TIME_S))
    outer.axes.append(
        Axis(
            name="hidden axis",
            direction=direction,
            at_m=point,
            stiffness=stiffness,
            damping=loss * stiffness,
        )
    )
    behind = [name for name, p in rig.machine.places.items() if p.body == outer.name]
    before = [name for name, p in rig.machine.places.items() if p.body == place]
    half = rig.machine.bodies[place].inertial
    whole = sum(b.mass_kg for b in (half, outer.inertial) if b is not None)
    return {
        "compliance_rad_per_n_m": 1.0 / stiffness,
        "direction": np.asarray(direction).tolist(),
        "point_m": point.tolist(),
        "points_before": before,
        "points_behind": behind,
        "mass_before": 0.0 if half is None else half.mass_kg / whole,
        "loss_time_s": loss,
    }
