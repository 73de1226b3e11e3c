"""An axis askew in a link, about which the outer part turns on a spring."""

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit, stiffer_at_told
from armodal.hil_sim.makers.frame.parts import Hinge
from armodal.hil_sim.makers.frame.standing import middle_of

RANGE = (0.004, 3.0)  # compliance over the softest drive's
PART = (0.28, 0.72)  # of the shell's line
BESIDE = 0.28  # of the diameter
LOSS = (0.01, 0.08)


def where(drawn: Everyday) -> list[str]:
    """A link between elastic joints."""
    return [row.link for row in drawn.table.links[1:4]]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Cut the shell and join it by the hinge."""
    row, part = kit.row(place), float(kit.rng.uniform(*PART))
    point = middle_of(row, part) + BESIDE * row.shell.diameter_m * kit.anywhere()
    direction, loss = kit.anywhere(), float(kit.rng.uniform(*LOSS))
    compliance = size * kit.softest()
    kit.parts.hinges[place] = Hinge(
        part=part, direction=direction, point_m=point, compliance=compliance, loss=loss
    )
    return {
        "compliance_rad_per_n_m": compliance / stiffer_at_told(loss),
        "direction": direction.tolist(),
        "point_m": np.asarray(point).tolist(),
        "part": part,
        "loss_factor": loss,
    }
