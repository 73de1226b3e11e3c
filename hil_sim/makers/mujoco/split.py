"""A link as two bodies, for what turns inside it."""

from __future__ import annotations

import numpy as np

from armodal.hil_sim.makers.arm_table import Array, Inertial, LinkRow
from armodal.hil_sim.makers.mujoco.machine import Body, Machine
from armodal.hil_sim.makers.shell_points import along

__all__ = ["MIDDLE", "outer_half"]

MIDDLE = 0.5  # of the shell's line: where a link is cut
SPREAD = 0.5  # of the most that a link's inertia lets its halves lie apart


def outer_half(machine: Machine, row: LinkRow) -> tuple[Body, Array, Array]:
    """Return the outer half of a link, and the cut's place and normal, each (3,).

    The halves have equal masses, apart along the shell as far as the link's inertia allows; they
    are cut once, and what they carry and the points on them go with them.
    """
    at, tangent = along(row.shell, MIDDLE)
    name = f"{row.link} outer"
    if name in machine.bodies:
        return machine.bodies[name], at, tangent
    inner = machine.bodies[row.link]
    if inner.inertial is None:
        raise ValueError(f"{row.link} has no mass to be parted")
    near, far = _halves(inner.inertial, tangent)
    inner.inertial = near
    for body in machine.bodies.values():
        if body.parent == row.link:
            body.parent = name
    outer = Body(name=name, parent=row.link, T_parent_body=np.eye(4), inertial=far)
    machine.bodies[name] = outer
    for place in machine.places.values():
        if place.body == row.link and (place.at_m - at) @ tangent > 0.0:
            place.body = name
    return outer, at, tangent


def _halves(whole: Inertial, tangent: Array) -> tuple[Inertial, Inertial]:
    """Two bodies of half the mass that together have mass, centre and inertia of the whole."""
    inertia = whole.matrix()
    across = np.eye(3) - np.outer(tangent, tangent)
    # Each half lies d from the centre and takes m d^2 / 2 off what is left across the tangent.
    second = 0.5 * np.trace(inertia) * np.eye(3) - inertia  # integral of r r^T dm
    d = np.sqrt(SPREAD * max(float(tangent @ second @ tangent), 0.0) / whole.mass_kg)
    left = 0.5 * (inertia - whole.mass_kg * d * d * across)
    near, far = (np.array(whole.center_m) + sign * d * tangent for sign in (-1.0, 1.0))
    half = 0.5 * whole.mass_kg
    return Inertial.of(half, near, left), Inertial.of(half, far, left)
