"""A damper between the ground and a link: a hose that drags on the floor."""

import numpy as np

from armodal.hil_sim.makers.frame.drive_loss import LOSS_AT_HZ
from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.standing import Standing, middle_of
from armodal.hil_sim.makers.frame.structure import Complex

RANGE = (0.05, 2000.0)  # of the first drive's loss at `LOSS_AT_HZ` over the square of a metre


def where(drawn: Everyday) -> list[str]:
    """To the third link or the next."""
    return [f"floor|{row.link}" for row in drawn.table.links[2:4]]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Let it drag along one drawn line, fixed in the cell."""
    link, joint = place.split("|")[1], kit.drawn.elastic[0]
    loss = kit.drawn.loss[joint].factor
    damping = size * loss * kit.parts.drives[joint].stiffness / (2.0 * np.pi * LOSS_AT_HZ)
    at = middle_of(kit.row(link), float(kit.rng.uniform(0.35, 1.0)))
    reach = sum(float(np.linalg.norm(row.xyz_m)) for row in kit.drawn.table.links)
    foot = reach * kit.rng.uniform(-0.7, 0.7, 3) * np.array([1.0, 1.0, 0.0])

    def law(s: Complex) -> Complex:
        return damping * s

    def span(standing: Standing) -> None:
        line = standing.place(link, at) - foot
        T = standing.structure.motion(standing.spot(link, at))
        standing.structure.laws.append((line / np.linalg.norm(line) @ T[:3], law))

    kit.parts.last.append(span)
    return {
        "damping_n_s_per_m": damping,
        "from_m": foot.tolist(),
        "to_m": np.asarray(at).tolist(),
    }
