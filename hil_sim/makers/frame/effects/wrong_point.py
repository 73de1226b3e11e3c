"""The labels of two points of a link have been exchanged."""

from itertools import combinations

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.shell_points import shell_points

RANGE = None


def where(drawn: Everyday) -> list[str]:
    """Two points of one link beyond the first, neither of them the one that is hit."""
    links = {row.link for row in drawn.table.links[1:]}
    points = [point for point in shell_points(drawn.table) if point.link in links][1:]
    return [f"{a.id}|{b.id}" for a, b in combinations(points, 2) if a.link == b.link]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Exchange where the sensor truly is."""
    del size
    a, b = place.split("|")
    kit.gear.exchanged |= {a: b, b: a}
    return {"exchanged": [a, b]}
