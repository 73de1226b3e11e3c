"""Dry friction of a joint: with or without a spring before it slips."""

from armodal.hil_sim.makers.mujoco.machine import Spring
from armodal.hil_sim.makers.mujoco.ordinary import Ordinary
from armodal.hil_sim.makers.mujoco.rig import Parameters, Rig

SPAN = (0.002, 1.0)  # of the moment that a middle hit at full reach puts on the drive
PRESLIDING = (0.3, 4.0)  # its stiffness over the drive's


def places(drawn: Ordinary) -> list[str]:
    """One of the first three joints."""
    return list(drawn.elastic[:3])


def put(rig: Rig, place: str, size: float) -> Parameters:
    """Put a Coulomb element beside the drive; a coin tells whether it gives way before it slips.

    With presliding it is a Jenkins element: a spring that yields at the limit.
    """
    drive = rig.drive(place)
    limit = size * middle_moment(rig)
    if rig.rng.random() < 0.5:
        drive.coulomb = limit
        return {"limit_n_m": limit, "stiffness_n_m_per_rad": None}
    stiffness = float(rig.rng.uniform(*PRESLIDING)) * drive.stiffness
    rig.machine.springs.append(
        Spring(name="friction", axes={place: 1.0}, stiffness=stiffness, yields_at=limit / stiffness)
    )
    return {"limit_n_m": limit, "stiffness_n_m_per_rad": stiffness}


def middle_moment(rig: Rig) -> float:
    """Moment of a middle hit's mean force over its ringing, half the arm's reach away, N m."""
    table = rig.drawn.table
    reach = sum(abs(x) + abs(y) + abs(z) for row in table.links for x, y, z in [row.xyz_m])
    return 0.5 * reach * table.peaks_n[1] * 0.1
