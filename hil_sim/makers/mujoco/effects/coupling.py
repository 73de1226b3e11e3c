"""Two neighbouring drives share a part that gives way: turning one loads the other."""

from itertools import pairwise

import numpy as np

from armodal.hil_sim.makers.mujoco.machine import Spring
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.01, 0.6)  # of the geometric mean of both stiffnesses


def places(drawn: Ordinary) -> list[str]:
    """Neighbours among the first four elastic joints."""
    names = drawn.elastic[:4]
    return [f"{a}|{b}" for a, b in pairwise(names)]


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Span a tendon over both axes; the drives lose what it adds to them."""
    first, second = place.split("|")
    a, b = rig.drive(first), rig.drive(second)
    cross = size * float(np.sqrt(a.stiffness * b.stiffness))
    sign = float(rig.rng.choice([-1.0, 1.0]))
    ratio = float(np.sqrt(b.stiffness / a.stiffness))  # each drive loses the same part
    a.stiffness -= cross / ratio
    b.stiffness -= cross * ratio
    rig.machine.springs.append(
        Spring(
            name="coupling",
            axes={first: 1.0, second: sign * ratio},
            stiffness=cross / ratio,
        )
    )
    return {"cross_stiffness_n_m_per_rad": sign * cross}
