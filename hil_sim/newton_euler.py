"""Newton-Euler inverse dynamics of a chain of rigid bodies that turn or slide.

Written for the simulated laboratory alone, so that it shares no line with the arm model of the
estimator it tests. Everything is written in base axes. The forward recursion over the bodies is a
cumulative sum along the chain, the backward recursion one along the chain reversed, so that many
states are evaluated at once: leading dimensions are batch dimensions.

References
----------
Luh, Walker, Paul, J. Dyn. Sys. Meas. Control 102 (1980) 69; Featherstone, "Rigid Body Dynamics
Algorithms" (2008), chapter 5.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

__all__ = [
    "Body",
    "Chain",
    "Placement",
    "gravity_stiffness",
    "gravity_torque",
    "inverse_dynamics",
    "mass_matrix",
    "place",
    "point_jacobian",
    "rotation",
    "skew",
    "with_point_mass",
]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """A rigid body and the hinge that ties it to the body before it.

    The body's frame stands at `origin_m`, `R_parent_body` in the frame of the body before it
    while the hinge is at zero. The hinge turns the body about the line through `hinge_m` along
    `axis`, both in the body's frame; a drive's hinge passes through the frame's origin. A hinge
    that `slides` moves the body along the axis instead: angles are then lengths in m, torques
    forces in N.
    """

    name: str
    origin_m: Array  # (3,) in the frame of the body before
    R_parent_body: Array  # (3, 3)
    hinge_m: Array  # (3,) a point of the hinge line, body frame
    axis: Array  # (3,) unit, body frame
    mass_kg: float
    center_m: Array  # (3,) body frame
    inertia_kg_m2: Array  # (3, 3) about the center, body axes
    slides: bool = False


@dataclass(frozen=True, kw_only=True)
class Chain:
    """Bodies from the base outwards, and the gravity they live in.

    Many linearisations are made of one chain: what they read of its bodies is stacked once.
    """

    bodies: tuple[Body, ...]
    gravity_m_s2: Array  # (3,) base frame

    @property
    def n(self) -> int:
        """Number of hinges."""
        return len(self.bodies)

    @cached_property
    def turns(self) -> Array:
        """(n, 1) one for hinges that turn, zero for those that slide."""
        return np.array([[0.0 if body.slides else 1.0] for body in self.bodies])

    @cached_property
    def axis(self) -> Array:
        """(n, 3) of the hinges, each in its body's frame."""
        return np.array([body.axis for body in self.bodies])

    @cached_property
    def step_m(self) -> Array:
        """(n, 3) from each body's frame to the next hinge, in the frame of the body before."""
        return np.array([b.origin_m + b.R_parent_body @ b.hinge_m for b in self.bodies])

    @cached_property
    def turn_before(self) -> Array:
        """(n, 3, 3) while the hinges are at zero."""
        return np.array([body.R_parent_body for body in self.bodies])

    @cached_property
    def rodrigues(self) -> tuple[Array, Array]:
        """(n, 3, 3) each: skew matrices of the axes and their squares, zero where one slides."""
        S = np.array([skew(body.axis) for body in self.bodies]) * self.turns[:, None]
        return S, S @ S

    @cached_property
    def masses(self) -> tuple[Array, Array, Array]:
        """Mass (n,), center (n, 3) and inertia (n, 3, 3) of the bodies."""
        return (
            np.array([body.mass_kg for body in self.bodies]),
            np.array([body.center_m for body in self.bodies]),
            np.array([body.inertia_kg_m2 for body in self.bodies]),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Placement:
    """Where the bodies are: frames and hinge lines in base axes, batch dimensions first."""

    R: Array  # (..., n, 3, 3)
    origin_m: Array  # (..., n, 3)
    hinge_m: Array  # (..., n, 3)
    axis: Array  # (..., n, 3)
    turns: Array  # (n, 1) one for hinges that turn, zero for those that slide


def cross(a: Array, b: Array) -> Array:
    """Vector product over the last dimension, (..., 3)."""
    return np.stack(
        (
            a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1],
            a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
            a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0],
        ),
        axis=-1,
    )


def skew(v: Array) -> Array:
    """(3, 3) matrix S with S @ w = v x w."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def rotation(axis: Array, angle_rad: npt.ArrayLike) -> Array:
    """Rotation matrices about a unit axis by Rodrigues' formula, (..., 3, 3)."""
    angle = np.asarray(angle_rad, dtype=np.float64)[..., None, None]
    S = skew(axis)
    result: Array = np.eye(3) + np.sin(angle) * S + (1.0 - np.cos(angle)) * (S @ S)
    return result


def place(chain: Chain, q_rad: Array) -> Placement:
    """Frames of all bodies for hinge angles (..., n)."""
    batch = q_rad.shape[:-1]
    S, SS = chain.rodrigues
    angle = q_rad[..., None, None]
    turned = chain.turn_before @ (np.eye(3) + np.sin(angle) * S + (1.0 - np.cos(angle)) * SS)
    slid = (1.0 - chain.turns) * chain.axis * q_rad[..., None]
    R = np.empty((*batch, chain.n, 3, 3))
    origin, hinge = np.empty((*batch, chain.n, 3)), np.empty((*batch, chain.n, 3))
    R_before: Array = np.broadcast_to(np.eye(3), (*batch, 3, 3))
    before = np.zeros((*batch, 3))
    for i, body in enumerate(chain.bodies):
        here = R[..., i, :, :]
        np.matmul(R_before, turned[..., i, :, :], out=here)
        at = before + R_before @ chain.step_m[i]
        if body.slides:
            at = at + (here @ slid[..., i, :, None])[..., 0]
        hinge[..., i, :] = at
        origin[..., i, :] = before = at - here @ body.hinge_m
        R_before = here
    axis = (R @ chain.axis[:, :, None])[..., 0]
    return Placement(R=R, origin_m=origin, hinge_m=hinge, axis=axis, turns=chain.turns)


def inverse_dynamics(chain: Chain, q_rad: Array, qd_rad_s: Array, qdd_rad_s2: Array) -> Array:
    """Hinge torques for a motion, gravity included.

    Parameters
    ----------
    q_rad, qd_rad_s, qdd_rad_s2
        (..., n) angles, velocities and accelerations of the hinges; batch dimensions broadcast.

    Returns
    -------
    (..., n) float64
        Torques in N m that the hinges must exert.
    """
    at = place(chain, q_rad)
    mass, center_local, inertia_local = chain.masses
    Rt = np.swapaxes(at.R, -1, -2)
    inertia = at.R @ inertia_local @ Rt
    center = at.origin_m + np.einsum("...ij,...j->...i", at.R, center_local)

    # Outwards: angular velocity and acceleration of each body, acceleration of its hinge point.
    # Gravity enters as an acceleration of the base upwards.
    spin = at.turns * at.axis * qd_rad_s[..., None]
    slide = (1.0 - at.turns) * at.axis * qd_rad_s[..., None]
    omega = np.cumsum(spin, axis=-2)
    omega_before = omega - spin
    push = at.axis * qdd_rad_s2[..., None]
    alpha = np.cumsum(at.turns * push + cross(omega_before, spin), axis=-2)
    lever = np.diff(at.hinge_m, axis=-2, prepend=0.0)
    still = np.zeros_like(alpha[..., :1, :])
    alpha_before = np.concatenate((still, alpha[..., :-1, :]), axis=-2)
    hinge_step = cross(alpha_before, lever) + cross(omega_before, cross(omega_before, lever))
    hinge_step = hinge_step + 2.0 * cross(omega_before, slide) + (1.0 - at.turns) * push
    hinge_acc = np.cumsum(hinge_step, axis=-2) - chain.gravity_m_s2
    arm = center - at.hinge_m
    center_acc = hinge_acc + cross(alpha, arm) + cross(omega, cross(omega, arm))

    # Inwards: forces, and their moments about the base's origin, summed from the tip.
    force = mass[:, None] * center_acc
    turning = np.einsum("...ij,...j->...i", inertia, omega)
    moment = np.einsum("...ij,...j->...i", inertia, alpha) + cross(omega, turning)
    return _at_hinges(at, force, moment + cross(center, force))


def _at_hinges(at: Placement, force: Array, moment: Array) -> Array:
    """Torques (..., n) of forces on the bodies and their moments about the base's origin."""
    force_beyond = np.cumsum(force[..., ::-1, :], axis=-2)[..., ::-1, :]
    moment_beyond = np.cumsum(moment[..., ::-1, :], axis=-2)[..., ::-1, :]
    about_hinge = moment_beyond - cross(at.hinge_m, force_beyond)
    wanted = at.turns * about_hinge + (1.0 - at.turns) * force_beyond
    torque: Array = np.sum(at.axis * wanted, axis=-1)
    return torque


def gravity_torque(chain: Chain, q_rad: Array) -> Array:
    """Torques (..., n) in N m that hold the chain at rest."""
    at = place(chain, q_rad)
    mass, center_local, _ = chain.masses
    center = at.origin_m + (at.R @ center_local[:, :, None])[..., 0]
    force = np.broadcast_to(-mass[:, None] * chain.gravity_m_s2, center.shape)
    return _at_hinges(at, force, cross(center, force))


def mass_matrix(chain: Chain, q_rad: Array) -> Array:
    """Mass matrix (n, n) in kg m^2 at angles (n,), column by column from unit accelerations."""
    weightless = replace(chain, gravity_m_s2=np.zeros(3))
    columns = inverse_dynamics(weightless, q_rad, np.zeros(chain.n), np.eye(chain.n))
    result: Array = 0.5 * (columns + columns.T)
    return result


def gravity_stiffness(chain: Chain, q_rad: Array) -> Array:
    """Stiffness (n, n) in N m / rad that gravity adds at angles (n,): dg/dq.

    Central differences of the holding torques. A step of 1e-4 rad leaves a truncation error of
    about h^2/6 and a rounding error of about 1e-16/h, both below 1e-8 of the largest entry.
    """
    h = 1e-4
    steps = h * np.eye(chain.n)
    ahead, behind = gravity_torque(chain, q_rad + np.stack((steps, -steps)))
    slope = (ahead - behind) / (2.0 * h)
    result: Array = 0.5 * (slope + slope.T)
    return result


def point_jacobian(at: Placement, body: int, point_m: Array) -> Array:
    """Velocity of a point fixed in `body` and now at `point_m` (base axes), per hinge velocity.

    Returns
    -------
    (6, n) float64
        Three rows of linear velocity, three of angular velocity.
    """
    n = at.axis.shape[-2]
    J = np.zeros((6, n))
    carried = slice(0, body + 1)
    turns, axis = at.turns[carried], at.axis[carried]
    turned = cross(axis, point_m - at.hinge_m[carried])
    J[:3, carried] = (turns * turned + (1.0 - turns) * axis).T
    J[3:, carried] = (turns * axis).T
    return J


def with_point_mass(chain: Chain, body: int, position_m: Array, mass_kg: float) -> Chain:
    """Return a chain whose `body` carries a point mass at `position_m` (body frame)."""
    old = chain.bodies[body]
    total = old.mass_kg + mass_kg
    if total == 0.0:
        return chain
    center = (old.mass_kg * old.center_m + mass_kg * position_m) / total
    inertia = old.inertia_kg_m2.copy()
    for mass, position in ((old.mass_kg, old.center_m), (mass_kg, position_m)):
        S = skew(position - center)
        inertia -= mass * S @ S
    loaded = replace(old, mass_kg=total, center_m=center, inertia_kg_m2=inertia)
    bodies = (*chain.bodies[:body], loaded, *chain.bodies[body + 1 :])
    return replace(chain, bodies=bodies)
