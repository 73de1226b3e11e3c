"""A sensor or hammer was at another point of the same link than the session says."""

from itertools import combinations

from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = None


def places(drawn: Ordinary) -> list[str]:
    """Two points of one link from the second on, exchanged."""
    places = drawn.machine.places
    rows = drawn.table.links[1:]
    pairs = combinations(sorted(places, key=int), 2)
    owner = {name: place.body.removesuffix(" outer") for name, place in places.items()}
    known = {row.link for row in rows}
    return [f"{a}|{b}" for a, b in pairs if owner[a] == owner[b] and owner[a] in known]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Exchange the two points."""
    del size
    a, b = place.split("|")
    places = rig.machine.places
    places[a], places[b] = places[b], places[a]
    return {"exchanged": [a, b]}
