"""Inertials of links of which none is given, or none to be believed: from their hulls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.own_arm.hull_mass import (
    DENSITY,
    MASS_KNOWN_TOTAL,
    MASS_LAST,
    MASS_NO_TOTAL,
    SLENDER,
    hull_mass,
)
from armodal.analyzer.own_arm.plausible import NEAR_MISS, Doubts, nearest_body, on_a_frame
from armodal.analyzer.own_arm.surface import Surface
from armodal.protocols.arm.inertial import physical_link
from armodal.protocols.arm.records import InertialLink, InertialStd
from armodal.protocols.errors import ArmError
from armodal.protocols.robot.records import Inertial
from armodal.protocols.robot.remarks import Remarks

__all__ = ["BelievedLinks", "believed_links", "guessed_inertial"]

# One standard deviation over the links of the same 26 arms: of the moments beyond the mass, and of
# the centre in parts of the body's longest side, rounded up.
INERTIA = 0.47
CENTER_OF_SIZE = 0.08
# As a maker's drawings give them, rounded, without cables.
GIVEN = (0.05, 0.1, 0.005)
DATA_SHEET = 0.02  # of its mass, which is rounded and may count cables
_ROUNDING = 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class BelievedLinks:
    """Inertials to put in the arm file, and how well each is known."""

    links: tuple[InertialLink, ...]
    guessed: tuple[str, ...]
    stds: tuple[InertialStd, ...]  # of each link
    moving_mass: float | None  # relative, of all links together, where a total is shared

    @property
    def mass(self) -> float:
        """Relative standard deviation of the worst mass."""
        return max(std.mass for std in self.stds)

    @property
    def inertia(self) -> float:
        """Relative standard deviation of the worst moments."""
        return max(std.inertia for std in self.stds)

    @property
    def center_m(self) -> float:
        """Standard deviation of the worst centre."""
        return max(std.center_m for std in self.stds)


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
        Mass of the whole arm, base included unless the base is a frame that the arm stands on:
        what is guessed shares what is left of it.

    Returns
    -------
    BelievedLinks or None
        None after a fault: a link that no inertial can be found for.
    """
    weighed = {
        body.name: doubts.scale * body.inertial.mass_kg
        for body in bodies[1:]
        if body.inertial is not None and body.name not in doubts.mass
    }
    together = _weighed_together(bodies, total_kg, said)
    masses = _masses(together, weighed, total_kg)
    if doubts.scale != 1.0:
        said.guess(
            "arm",
            f"masses and moments as described times {doubts.scale:.3g}, to the data sheet's mass",
        )
    links = []
    guessed = []
    for body in bodies[1:]:
        own = body.inertial
        if own is None or body.name in doubts.spread:
            guessed.append(body)
            own = guessed_inertial(body.seen, masses[body.name])
            shape = "convex hull" if body.drawn else "capsule"
            if body.name in weighed:
                by = "as described" if doubts.scale == 1.0 else "as described, scaled"
            elif total_kg is not None:
                by = f"by share of {total_kg:g} kg"
            else:
                by = f"by {DENSITY:g} kg/m³ times compactness to the {SLENDER:g}"
            said.guess(
                f"link {body.name}",
                f"inertial of its {shape}, {own.mass_kg:.3g} kg {by} (docs/own-arm.md)",
            )
        elif doubts.scale != 1.0:
            own = replace(
                own,
                mass_kg=doubts.scale * own.mass_kg,
                inertia_kg_m2=doubts.scale * own.inertia_kg_m2,
            )
        try:
            links.append(_physical(body.name, own, said))
        except ArmError as problem:
            said.fault(f"link {body.name}", str(problem))
    if said.of("fault"):
        return None
    names = {body.name for body in guessed}
    stds = tuple(
        _std(body, body.name in weighed, body.name in names, body is bodies[-1], doubts, total_kg)
        for body in bodies[1:]
    )
    return BelievedLinks(
        links=tuple(links),
        guessed=tuple(body.name for body in guessed),
        stds=stds,
        moving_mass=None
        if total_kg is None or len(weighed) == len(links)
        else _moving_mass_std(links, stds, masses.get(bodies[0].name, 0.0), total_kg),
    )


def _std(
    body: ArmBody,
    weighed: bool,
    guessed: bool,
    last: bool,
    doubts: Doubts,
    total_kg: float | None,
) -> InertialStd:
    mass, inertia, center = GIVEN
    mass = max(mass, abs(float(np.log(doubts.scale))))
    if not weighed:
        mass = MASS_NO_TOTAL if total_kg is None else MASS_KNOWN_TOTAL
        mass = max(mass, MASS_LAST) if last else mass
    if guessed:
        inertia, center = INERTIA, max(center, CENTER_OF_SIZE * body.seen.size_m)
    return InertialStd(mass=mass, inertia=inertia, center_m=center, guessed=guessed)


def _moving_mass_std(
    links: Sequence[InertialLink], stds: Sequence[InertialStd], base_kg: float, total_kg: float
) -> float:
    """How well the moving links' sum is known, relative: the base may have taken of theirs."""
    moving = sum((std.mass * link.mass_kg) ** 2 for std, link in zip(stds, links, strict=True))
    base = (MASS_KNOWN_TOTAL * base_kg) ** 2
    shared = base * moving / max(base + moving, 1e-12)
    return float(
        np.sqrt(shared + (DATA_SHEET * total_kg) ** 2) / sum(link.mass_kg for link in links)
    )


def _weighed_together(
    bodies: Sequence[ArmBody], total_kg: float | None, said: Remarks
) -> Sequence[ArmBody]:
    """The bodies that the data sheet's mass is of."""
    if total_kg is None or not on_a_frame(bodies, total_kg):
        return bodies
    said.note(
        f"link {bodies[0].name}",
        f"too heavy or too large for an arm's base: the {total_kg:g} kg are the moving links'",
    )
    return bodies[1:]


def _masses(
    bodies: Sequence[ArmBody], weighed: dict[str, float], total_kg: float | None
) -> dict[str, float]:
    """Mass of every body, kg: as described, or by hull with all others of a known total."""
    weights = {body.name: hull_mass(body.seen) for body in bodies if body.name not in weighed}
    if total_kg is None:
        return weighed | weights
    left = total_kg - sum(weighed.values())
    scale = max(left, 0.0) / max(sum(weights.values()), 1e-12)
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
