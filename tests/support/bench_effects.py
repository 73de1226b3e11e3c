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


FIRST, OTHERS = "first places", "last places"


def at_end(instances, end):
    """Of every effect its first place along the arm, or its last where it has several."""
    places = {}
    for instance in instances:
        places.setdefault(instance.effect.name, []).append(instance)
    ends = (own[:1] if end == FIRST else own[1:][-1:] for own in places.values())
    return [each for own in ends for each in own]
