"""A cylinder clamped to a link, of which the arm file knows nothing."""

import numpy as np

from armodal.hil_sim.makers.arm_table import Inertial
from armodal.hil_sim.makers.frame.everyday import Everyday
from armodal.hil_sim.makers.frame.kit import Hidden, Kit
from armodal.hil_sim.makers.frame.standing import middle_of

RANGE = (0.003, 0.5)  # of the moving mass
SLENDER = (0.32, 2.9)  # length over diameter
DENSITY_KG_M3 = (900.0, 7800.0)


def where(drawn: Everyday) -> list[str]:
    """The flange mostly, or a link of the outer half."""
    rows = drawn.table.links
    return [rows[-1].link] * 2 + [row.link for row in rows[3:-1]]


def hide(kit: Kit, place: str, size: float) -> Hidden:
    """Clamp on a cylinder of some density, anyhow turned."""
    mass, row = size * kit.arm_kg(), kit.row(place)
    slender = float(np.exp(kit.rng.uniform(*np.log(SLENDER))))
    density = kit.rng.uniform(*DENSITY_KG_M3)
    radius = (mass / (density * 2.0 * np.pi * slender)) ** (1.0 / 3.0)
    across = mass * radius**2 * (0.25 + slender**2 / 3.0)
    axis = kit.anywhere()
    inertia = across * np.eye(3) + (0.5 * mass * radius**2 - across) * np.outer(axis, axis)
    reach = 0.5 * row.shell.diameter_m + radius * max(1.0, slender)
    center = middle_of(row, float(kit.rng.uniform(0.32, 1.0))) + reach * kit.anywhere()
    kit.parts.added.append((place, Inertial.of(mass, center, inertia)))
    return {
        "mass_kg": mass,
        "center_m": center.tolist(),
        "inertia_kg_m2": inertia.tolist(),
        "radius_of_gyration_m": float(np.sqrt(np.trace(inertia) / 3.0 / mass)),
    }
