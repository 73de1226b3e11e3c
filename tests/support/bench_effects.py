"""Effects of the library in one posture of bench57."""

import numpy as np
from support.without_errors import without_errors

from armodal.analyzer.gap.library import all_instances

JOINTS = np.deg2rad([10.0, -35.0, 20.0, 15.0, 40.0, 20.0])


def instance_of(ordinary, name, place=""):
    return next(
        i for i in all_instances(ordinary) if i.effect.name == name and i.place.startswith(place)
    )


def start_of(hypothesis):
    """Values to begin with, bearings and loss at zero."""
    space = hypothesis.space()
    return without_errors(space.values(space.start()))


def at_both_ends(instances):
    """Of every effect its first and its last place along the arm."""
    places = {}
    for instance in instances:
        places.setdefault(instance.effect.name, []).append(instance)
    return [each for own in places.values() for each in (own[0], *own[1:][-1:])]
