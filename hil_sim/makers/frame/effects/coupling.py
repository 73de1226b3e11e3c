"""Two neighbouring drives that load each other."""

from itertools import pairwise

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.standing import Standing

RANGE = (0.01, 0.7)  # of the geometric mean of both stiffnesses


def where(drawn: Everyday) -> list[str]:
    """Neighbours among the first elastic joints."""
    return [f"{a}|{b}" for a, b in pairwise(drawn.elastic[:4])]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Put a term into the stiffness between both turns."""
    first, second = place.split("|")
    drives = kit.parts.drives
    mean = np.sqrt(drives[first].stiffness * drives[second].stiffness)
    cross = float(size * mean * kit.rng.choice([-1.0, 1.0]))

    def span(standing: Standing) -> None:
        a, b = standing.turn(first), standing.turn(second)
        rows = np.arange(len(a), dtype=np.intp)
        standing.structure.elastic.append((rows, cross * (np.outer(a, b) + np.outer(b, a)), 0.0))

    kit.parts.last.append(span)
    return {"cross_stiffness_n_m_per_rad": cross}
