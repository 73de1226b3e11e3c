"""Whether a body can have the inertial that a description gives it.

Exact bounds, of mass that lies inside the body's convex hull: its centre is inside, and its mean
square about the centre along any direction is at most (top - centre)(centre - bottom) of the
hull's extent there (R. Bhatia, C. Davis, Amer. Math. Monthly 107 (2000) 353). An inertia is that
of a body where half its trace less itself is positive semidefinite, which is the triangle
inequality of its principal moments (P. Wensing et al., IEEE Robot. Autom. Lett. 3 (2018) 60,
Eq. 13).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.own_arm.hull_mass import MASS_KNOWN_TOTAL, hull_mass
from armodal.analyzer.own_arm.surface import Surface
from armodal.protocols.robot.records import Inertial
from armodal.protocols.robot.remarks import Remarks

__all__ = ["Doubts", "doubted", "nearest_body", "on_a_frame"]

Array = npt.NDArray[np.float64]

NEAR_MISS = 0.05  # of the sum of two moments that the third exceeds: rounding, fitted inertias
_ROUNDING = 1e-3  # as `protocols.arm.inertial` lets pass
# Bearings, gears and motors may reach past a simplified mesh by this part of its size.
_BEYOND = 0.1
_CAPSULE = 2.0  # a capsule put in may be half as large as the link
_CONCENTRATED = 0.02  # of the mean square of a full hull: all mass in its seventh part
# Over the hull. Links of twenty public arms have 450 to 3100 (see docs/own-arm.md); steel is 7850.
_DENSITY = (150.0, 7850.0)
_ARM_DENSITY = 2400.0  # of all moving links: 700 to 1500 in those arms; solid aluminium is 2700
_TOTAL = 0.1  # of a data sheet's mass, which counts cables and covers
_LEAST_MOVING = 0.35  # of a data sheet's mass that moves
_ROUND_VALUES = (1.0, 0.1, 0.01, 0.001, 0.0001, 1e-5, 1e-6)


@dataclass(frozen=True, slots=True, kw_only=True)
class Doubts:
    """Names of moving bodies of which a part of the inertial should not be believed."""

    mass: frozenset[str]
    spread: frozenset[str]  # centre and moments; where the mass is doubted these are too
    scale: float = 1.0  # of all masses described, so that they are the data sheet's together


def nearest_body(inertia_kg_m2: Array) -> tuple[Array, float]:
    """The nearest inertia that a body can have, and by how much the given one misses.

    Nearest in the mean square of the mass about the centre: negative ones become zero, which is
    the projection onto the semidefinite matrices (N. Higham, Linear Algebra Appl. 103 (1988) 103).

    Returns
    -------
    inertia : (3, 3) float64
    excess : float
        Of the largest principal moment over the sum of the others, relative; 0 without one.
    """
    symmetric = 0.5 * (inertia_kg_m2 + inertia_kg_m2.T)
    moments = np.linalg.eigvalsh(symmetric)
    excess = float(moments[2] / max(moments[0] + moments[1], 1e-300) - 1.0)
    if excess <= 0.0:
        return symmetric, 0.0
    squares, axes = np.linalg.eigh(0.5 * np.trace(symmetric) * np.eye(3) - symmetric)
    second = axes @ np.diag(np.maximum(squares, 0.0)) @ axes.T
    return np.trace(second) * np.eye(3) - second, excess


def doubted(bodies: Sequence[ArmBody], said: Remarks, *, total_kg: float | None = None) -> Doubts:
    """Find the moving bodies whose inertial should not be believed, and say why.

    Parameters
    ----------
    bodies
        Base first.
    total_kg
        The whole arm's mass of its data sheet, base included.
    """
    moving = bodies[1:]
    masses, spreads = set(), set()
    for body in moving:
        if body.inertial is None:
            continue
        of_mass, of_spread = _of_mass(body, body.inertial), _of_spread(body, body.inertial)
        for reason in (*of_mass, *of_spread):
            said.doubt(f"link {body.name}", reason)
        if of_mass:
            masses.add(body.name)
        if of_spread:
            spreads.add(body.name)
    masses |= _alike(moving, said)
    scale = _of_all(bodies, total_kg, said)
    if scale is None or (masses and scale != 1.0):
        masses, scale = {body.name for body in moving}, 1.0
    return Doubts(mass=frozenset(masses), spread=frozenset(masses | spreads), scale=scale)


def _of_mass(body: ArmBody, inertial: Inertial) -> list[str]:
    mass, moments = inertial.mass_kg, _moments(inertial)
    if mass <= 0.0:
        return [f"wanted a mass above 0 kg, got {mass:g}"]
    reasons = []
    if _placeholder(moments):
        told = ", ".join(f"{moment:.4g}" for moment in moments)
        reasons.append(
            f"{mass:g} kg with moments {told} kg m² looks like a placeholder, not like a body"
        )
    volume = body.seen.hull_filling.volume_m3
    if body.drawn and not _DENSITY[0] <= mass / volume <= _DENSITY[1]:
        reasons.append(
            f"{mass:.3g} kg in a hull of {1e3 * volume:.3g} l are {mass / volume:.0f} kg/m³, "
            f"wanted {_DENSITY[0]:.0f} to {_DENSITY[1]:.0f}"
        )
    return reasons


def _moments(inertial: Inertial) -> Array:
    inertia = inertial.inertia_kg_m2
    return np.array(np.linalg.eigvalsh(0.5 * (inertia + inertia.T)), dtype=np.float64)


def _of_spread(body: ArmBody, inertial: Inertial) -> list[str]:
    if inertial.mass_kg <= 0.0:
        return []
    moments = _moments(inertial)
    told = ", ".join(f"{moment:.4g}" for moment in moments)
    if moments[0] <= 0.0:
        return [f"wanted principal moments above 0, got {told} kg m²"]
    reasons = []
    _, excess = nearest_body(inertial.inertia_kg_m2)
    if excess > NEAR_MISS:
        reasons.append(
            f"no body has the principal moments {told} kg m²: the largest exceeds the sum of the "
            f"other two by {100 * excess:.3g} %"
        )
    surface = body.seen
    slack = _BEYOND * surface.size_m * (1.0 if body.drawn else 3.0)
    outside = _outside_m(surface, inertial.center_m)
    if outside > slack:
        reasons.append(f"its centre of mass is {1e3 * outside:.0f} mm outside its surface")
    else:
        reasons += _spread(body, inertial, moments)
    return reasons


def _spread(body: ArmBody, inertial: Inertial, moments: Array) -> list[str]:
    """Compare the mean square of the mass about its centre with what the hull can hold."""
    surface, mass = body.seen, inertial.mass_kg
    second = 0.5 * np.trace(inertial.inertia_kg_m2) * np.eye(3) - inertial.inertia_kg_m2
    squares, axes = np.linalg.eigh(0.5 * (second + second.T) / mass)
    slack = _BEYOND * surface.size_m
    along = (surface.vertices_m - inertial.center_m) @ axes
    most = (along.max(axis=0).clip(0.0) + slack) * (-along.min(axis=0).clip(None, 0.0) + slack)
    most *= 1.0 if body.drawn else _CAPSULE**2
    if (squares > most).any():
        gyration = ", ".join(f"{np.sqrt(moment / mass):.3g}" for moment in moments)
        reaches = f"radii of gyration {gyration} m reaches outside its surface"
        return [f"mass {mass:.3g} kg with {reaches}, {surface.size_m:.3g} m long"]
    full = np.trace(surface.hull_filling.second_m2)
    if body.drawn and squares.sum() < _CONCENTRATED * full:
        gyration = f"radius of gyration {np.sqrt(moments[2] / mass):.3g} m"
        return [f"its mass lies in one spot: {gyration} in a body {surface.size_m:.3g} m long"]
    return []


def _outside_m(surface: Surface, point: Array) -> float:
    """How far a point is beyond the farthest face of the hull, m; below 0 inside."""
    equations = surface.hull.equations
    return float((equations[:, :3] @ point + equations[:, 3]).max())


def _placeholder(moments: Array) -> bool:
    same = bool(np.ptp(moments) <= 1e-9 * moments[2])
    return same and any(np.isclose(moments[0], value, rtol=1e-9) for value in _ROUND_VALUES)


def _alike(moving: Sequence[ArmBody], said: Remarks) -> set[str]:
    """Links of different sizes that have one and the same mass and moments."""
    groups: dict[tuple[float, ...], list[ArmBody]] = {}
    for body in moving:
        if body.inertial is not None:
            moments = np.linalg.eigvalsh(body.inertial.inertia_kg_m2)
            key = tuple(float(f"{value:.6g}") for value in (body.inertial.mass_kg, *moments))
            groups.setdefault(key, []).append(body)
    found: set[str] = set()
    for (mass, *_), same in groups.items():
        volumes = [body.seen.hull_filling.volume_m3 for body in same]
        if len(same) > 1 and max(volumes) > 1.5 * min(volumes):
            names = [body.name for body in same]
            said.doubt(
                f"links {', '.join(names)}",
                f"have one and the same mass, {mass:g} kg, and moments, and "
                f"hulls of {1e3 * min(volumes):.3g} to {1e3 * max(volumes):.3g} l",
            )
            found |= set(names)
    return found


def _of_all(bodies: Sequence[ArmBody], total_kg: float | None, said: Remarks) -> float | None:
    """The factor that gives all links the data sheet's mass; None if none of theirs is believed.

    Where they are off by less than a guess from hulls would be, their shares are the better guess.
    """
    moving = bodies[1:]
    given = [body.inertial for body in moving if body.inertial is not None]
    if len(given) < len(moving):
        return 1.0
    mass = sum(inertial.mass_kg for inertial in given)
    volume = sum(body.seen.hull_filling.volume_m3 for body in moving)
    if all(body.drawn for body in moving) and mass > _ARM_DENSITY * volume:
        said.doubt(
            "arm",
            f"its moving links are {mass:.4g} kg in hulls of {1e3 * volume:.4g} l, "
            f"{mass / volume:.0f} kg/m³, nearly solid metal; wanted below {_ARM_DENSITY:.0f}; "
            "give the data sheet's mass with --mass",
        )
        return None
    if total_kg is None:
        return 1.0
    frame = on_a_frame(bodies, total_kg)
    base = None if frame else bodies[0].inertial
    whole = mass + (base.mass_kg if base is not None else 0.0)
    known = base is not None or frame
    low = total_kg * ((1.0 - _TOTAL) if known else _LEAST_MOVING)
    if low <= whole <= total_kg * (1.0 + _TOTAL):
        return 1.0
    what = "links and base" if base is not None else "moving links"
    said.doubt("arm", f"its {what} are {whole:.4g} kg, the data sheet's mass is {total_kg:.4g} kg")
    near = known and abs(np.log(total_kg / whole)) <= MASS_KNOWN_TOTAL
    return float(total_kg / whole) if near else None


def on_a_frame(bodies: Sequence[ArmBody], total_kg: float) -> bool:
    """Whether the base is no part of the arm that the data sheet weighs: a pedestal, a vehicle.

    Its described mass is more than that of all, or its hull would weigh more than all moving ones.
    """
    base = bodies[0]
    heavy = base.inertial is not None and base.inertial.mass_kg > total_kg
    return heavy or (
        base.drawn and hull_mass(base.seen) > sum(hull_mass(body.seen) for body in bodies[1:])
    )
