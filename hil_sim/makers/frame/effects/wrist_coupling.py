"""A last drive that turns with the one before it, as in hollow wrists."""

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.standing import Standing

RANGE = (0.04, 1.4)  # turns of the last a turn of the one before
WRIST = "elastic"  # of a wrist that is believed rigid neither drive gives way


def where(drawn: Everyday) -> list[str]:
    """The last two joints, where they are elastic."""
    before, last = (row.joint for row in drawn.table.links[-2:])
    return [f"{before}|{last}"] if {before, last} <= set(drawn.elastic) else []


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Let the last drive's spring feel both turns."""
    before, last = place.split("|")
    ratio = float(size * kit.rng.choice([-1.0, 1.0]))
    stiffness = kit.parts.drives[last].stiffness

    def span(standing: Standing) -> None:
        a, b = standing.turn(before), standing.turn(last)
        both = ratio * a + b
        change = stiffness * (np.outer(both, both) - np.outer(b, b))
        standing.structure.elastic.append((np.arange(len(a), dtype=np.intp), change, 0.0))

    kit.parts.last.append(span)
    return {"ratio": ratio}
