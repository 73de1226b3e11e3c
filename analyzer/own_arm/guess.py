"""Inertials of links of which none is given, or none to be believed: from their hulls.

Links are not uniform: gears, motors and bearings sit in the short ones, long ones are tubes. Over
the moving links of 19 public arms that have meshes and inertials the density of a link's convex
hull falls with its slenderness,

    density = DENSITY · compactness ** SLENDER,

compactness the hull's volume over that of a ball with the same mean square about its centre. The
exponent holds from maker to maker: fitted to all makers but one it is 0.48 to 0.61, and tells the
links of the one left out to a factor of 1.37 (one standard deviation), against 1.65 with one
density (`bench/bench_own_arm.py --inertials`, docs/own-arm.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.own_arm.plausible import NEAR_MISS, Doubts, nearest_body
from armodal.analyzer.own_arm.surface import Surface
from armodal.protocols.arm.inertial import physical_link
from armodal.protocols.arm.records import InertialLink
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.records import Inertial
from armodal.protocols.robot.remarks import Remarks

__all__ = ["BelievedLinks", "believed_links", "compactness", "guessed_inertial"]

DENSITY = 1750.0  # kg/m³ over the hull of a ball
SLENDER = 0.55
# One standard deviation over those arms' links: of the mass with the arm's total known and without,
# of the moments beyond the mass, and of the centre in parts of the body's longest side.
MASS_KNOWN_TOTAL, MASS_NO_TOTAL = 0.30, 0.45
INERTIA = 0.35
CENTER_OF_SIZE = 0.08
# As a maker's drawings give them, rounded, without cables.
GIVEN = (0.05, 0.1, 0.005)
_ROUNDING = 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class BelievedLinks:
    """Inertials to put in the arm file, with one standard deviation of the worst of them."""

    links: tuple[InertialLink, ...]
    guessed: tuple[str, ...]
    mass: float
    inertia: float
    center_m: float


def compactness(surface: Surface) -> float:
    """Volume of the hull over that of a ball of the same mean square; 1 for a ball."""
    filled = surface.hull_filling
    # A ball of radius R has the mean square 3 R²/5.
    radius = np.sqrt(5.0 / 3.0 * np.trace(filled.second_m2))
    return float(filled.volume_m3 / (4.0 / 3.0 * np.pi * radius**3))


def guessed_inertial(surface: Surface, mass_kg: float) -> Inertial:
    """The inertial of a uniform hull of that mass."""
    filled = surface.hull_filling
    return Inertial(
        mass_kg=mass_kg,
        center_m=filled.center_m,
        inertia_kg_m2=mass_kg * filled.inertia_over_mass_m2,
    )


def believed_links(
    bodies: Sequence[ArmBody],
    doubts: Doubts,
    said: Remarks,
    *,
    total_kg: float | None = None,
) -> BelievedLinks | None:
    """Given inertials where they are believed, projected where they just miss, else guesses.

    Parameters
    ----------
    bodies
        Base first.
    doubts
        What is given and not believed. A doubted spread alone leaves the mass.
    total_kg
        Mass of the whole arm, base included: what is guessed shares what is left of it.

    Returns
    -------
    BelievedLinks or None
        None after a fault: a link that no inertial can be found for.
    """
    weighed = {
        body.name: body.inertial.mass_kg
        for body in bodies[1:]
        if body.inertial is not None and body.name not in doubts.mass
    }
    masses = _masses(bodies, weighed, total_kg)
    links = []
    guessed = []
    for body in bodies[1:]:
        own = body.inertial
        if own is None or body.name in doubts.spread:
            guessed.append(body)
            own = guessed_inertial(body.seen, masses[body.name])
            shape = "convex hull" if body.drawn else "capsule"
            if body.name in weighed:
                by = "as described"
            elif total_kg is not None:
                by = f"by share of {total_kg:g} kg"
            else:
                by = f"by {DENSITY:g} kg/m³ times compactness to the {SLENDER:g}"
            said.guess(
                f"link {body.name}",
                f"inertial of its {shape}, {own.mass_kg:.3g} kg {by} (docs/own-arm.md)",
            )
        try:
            links.append(_physical(body.name, own, said))
        except ArmError as problem:
            said.fault(f"link {body.name}", str(problem))
    if said.of("fault"):
        return None
    mass, inertia, center = GIVEN
    if len(weighed) < len(links):
        mass = MASS_NO_TOTAL if total_kg is None else MASS_KNOWN_TOTAL
    if guessed:
        inertia = INERTIA
        center = max(center, CENTER_OF_SIZE * max(body.seen.size_m for body in guessed))
    return BelievedLinks(
        links=tuple(links),
        guessed=tuple(body.name for body in guessed),
        mass=mass,
        inertia=inertia,
        center_m=center,
    )


def _masses(
    bodies: Sequence[ArmBody], weighed: dict[str, float], total_kg: float | None
) -> dict[str, float]:
    """Mass of every body, kg: as described, or by hull with all others of a known total."""
    weights = {
        body.name: DENSITY * body.seen.hull_filling.volume_m3 * compactness(body.seen) ** SLENDER
        for body in bodies
        if body.name not in weighed
    }
    if total_kg is None:
        return weighed | weights
    left = total_kg - sum(weighed.values())
    scale = max(left, 0.0) / sum(weights.values())
    return weighed | {name: scale * weight for name, weight in weights.items()}


def _physical(name: str, own: Inertial, said: Remarks) -> InertialLink:
    inertia, excess = nearest_body(own.inertia_kg_m2)
    if excess > NEAR_MISS:
        raise ArmError(f"no body has its moments, over the triangle limit by {100 * excess:.3g} %")
    if excess > _ROUNDING:
        said.note(
            f"link {name}",
            f"its largest moment exceeds the sum of the other two by {100 * excess:.2g} %: "
            "replaced by the nearest inertia that a body can have",
        )
    return physical_link(name, own.mass_kg, own.center_m, inertia)
