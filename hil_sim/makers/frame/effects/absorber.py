"""A mass on a spring and a damper on a link, such as a loose cover."""

import numpy as np

from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.standing import Standing, middle_of
from armodal.hil_sim.makers.frame.structure import Complex

RANGE = (0.0004, 0.2)  # of the moving mass
OWN_HZ = (8.0, 60.0)
LOSS = (0.02, 0.2)  # loss factor of its spring at its frequency


def where(drawn: Everyday) -> list[str]:
    """A link beyond the first."""
    return [row.link for row in drawn.table.links[1:]]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Condense it into the dynamic stiffness it adds along its direction."""
    rng, mass = kit.rng, size * kit.arm_kg()
    omega = 2.0 * np.pi * float(np.exp(rng.uniform(*np.log(OWN_HZ))))
    loss, direction = float(rng.uniform(*LOSS)), kit.anywhere()
    at = middle_of(kit.row(place), float(rng.uniform(0.1, 0.9)))

    def law(s: Complex) -> Complex:
        spring = mass * omega**2 * (1.0 + loss * s / omega)
        added: Complex = mass * s**2 * spring / (mass * s**2 + spring)
        return added

    def span(standing: Standing) -> None:
        T = standing.structure.motion(standing.spot(place, at))
        standing.structure.laws.append(((standing.poses[place][:3, :3] @ direction) @ T[:3], law))

    kit.parts.last.append(span)
    return {
        "mass_kg": mass,
        "frequency_hz": omega / (2.0 * np.pi),
        "damping_ratio": 0.5 * loss,
        "direction": direction.tolist(),
        "center_m": np.asarray(at).tolist(),
    }
