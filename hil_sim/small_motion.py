"""Small motion of the arm about a held posture: M q'' + C q' + (K + dg/dq) q = J^T f.

The coordinates are the hinges that give way and what effects add; Maxwell elements of effects add
states of first order.

The mass matrix is frozen at the posture; `docs/simulated-plant.md` gives what that costs beside the
full equations. The servos hold the gravity torque, so the springs' rest is the posture itself and
gravity leaves only its stiffness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.assembly import Spring
from armodal.hil_sim.effects import BaseEffect
from armodal.hil_sim.elements import Element
from armodal.hil_sim.linear import LinearTerms
from armodal.hil_sim.newton_euler import (
    Chain,
    Placement,
    gravity_stiffness,
    gravity_torque,
    mass_matrix,
    place,
    point_jacobian,
    skew,
    with_point_mass,
)
from armodal.hil_sim.plant import BASE, Plant
from armodal.protocols.errors import PlantError

__all__ = ["Mounting", "SmallMotion", "force_torque", "linearise", "sensor_rows"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Mounting:
    """How the accelerometer truly sits: at which test point, and its axes in the link's frame."""

    point_id: str
    R_link_sensor: Array  # (3, 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class SmallMotion:
    """The arm linearised about a posture, in its complex modes.

    With n coordinates and m Maxwell elements the state is (q, q', z) of length s = 2 n + m;
    `modes` holds the right eigenvectors in its columns and `inverse_modes` is its inverse.
    """

    at: Placement
    mass: Array  # (n, n) kg m^2
    damping: Array  # (n, n) N m s / rad
    stiffness: Array  # (n, n) N m / rad, gravity included
    state_matrix: Array  # (s, s)
    poles: ComplexArray  # (s,) rad/s
    modes: ComplexArray  # (s, s)
    inverse_modes: ComplexArray  # (s, s)
    sensed: Array  # (3, s) specific force in sensor axes per unit state
    sensed_direct: Array  # (3, n) the same per unit of torque
    elements: tuple[Element, ...] = ()  # what is not linear

    def residues(self, torque: Array) -> tuple[ComplexArray, Array]:
        """Transfer from a force to the sensor in partial fractions.

        Parameters
        ----------
        torque
            (n,) torque at the coordinates per newton of the force.

        Returns
        -------
        residues, direct
            (3, s) residues at `poles`, m/s^2 per N times rad/s, and (3,) the direct part,
            m/s^2 per N.
        """
        n = self.mass.shape[0]
        drive = np.zeros(len(self.poles))
        drive[n : 2 * n] = np.linalg.solve(self.mass, torque)
        residues = (self.sensed @ self.modes) * (self.inverse_modes @ drive)
        return residues, self.sensed_direct @ torque


def force_torque(plant: Plant, at: Placement, body: int, position_m: Array, force: Array) -> Array:
    """Torque (n,) in N m of a force (base axes) on a point fixed in a body's frame."""
    if body == BASE:
        return np.zeros(len(plant.coordinates))
    point = at.origin_m[body] + at.R[body] @ position_m
    J = _columns(plant, point_jacobian(at, body, point))
    torque: Array = J[:3].T @ force
    return torque


def linear_terms(plant: Plant, at: Placement, chain: Chain, q: Array) -> LinearTerms:
    """M, C, K and Maxwell elements at hinge angles q, with every effect's terms.

    Parameters
    ----------
    chain
        The plant's, with the accelerometer on it.
    """
    n, own = len(plant.coordinates), len(plant.springs)
    heavy = chain
    for effect in plant.truth.effects:
        for weight in effect.weights():
            body = plant.bodies.get(plant.carrier.get(weight.link, ""), BASE)
            if body != BASE:
                heavy = with_point_mass(heavy, body, weight.position_m, weight.mass_kg)
    free = np.ix_(plant.springs, plant.springs)
    M, C, K = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n))
    M[:own, :own] = mass_matrix(chain, q)[free]
    C[:own, :own] = np.diag(plant.damping)
    K[:own, :own] = np.diag(plant.stiffness) + gravity_stiffness(heavy, q)[free]
    hinge_of = dict(zip(plant.coordinates, range(own), strict=False))
    joints = {
        link.joint: hinge_of[link.joint] for link in plant.truth.links if link.joint in hinge_of
    }
    joint_names = [link.joint for link in plant.truth.links]
    terms = LinearTerms(
        chain=chain,
        at=at,
        labels=plant.coordinates,
        hinges=plant.springs,
        bodies=plant.bodies,
        carrier=plant.carrier,
        springs={
            name: Spring(k=float(plant.stiffness[i]), c=float(plant.damping[i]))
            for name, i in joints.items()
        },
        stretch={name: np.eye(n)[i] for name, i in joints.items()},
        M=M,
        C=C,
        K=K,
        load=dict(
            zip(joint_names, gravity_torque(heavy, q)[list(plant.joints)].tolist(), strict=True)
        ),
    )
    # Effects with coordinates of their own come first: others act on the springs they divide.
    for effect in sorted(plant.truth.effects, key=_first_to_act):
        effect.act(terms)
    return terms


def _first_to_act(effect: BaseEffect) -> tuple[bool, bool]:
    return not effect.coordinates(), not effect.winds_springs


def linearise(plant: Plant, joints_rad: npt.ArrayLike, mounting: Mounting | None) -> SmallMotion:
    """Linearise the arm about a posture, with the accelerometer's mass where it sits.

    What effects add beyond that is in `elements`.

    Raises
    ------
    PlantError
        If the arm would not come to rest in this posture.
    """
    q = plant.hinge_angles(joints_rad)
    at = place(plant.chain, q)
    chain = plant.chain
    point = None if mounting is None else plant.point(mounting.point_id)
    if point is not None and point.body != BASE:
        mass_kg = plant.truth.accelerometer.mass_kg + plant.sensing.extra_sensor_kg
        chain = with_point_mass(chain, point.body, point.position_m, mass_kg)
    terms = linear_terms(plant, at, chain, q)
    A = state_matrix(terms)
    n = len(plant.coordinates)
    poles, modes = np.linalg.eig(A)
    if np.any(poles.real >= 0.0):
        raise PlantError(
            f"{plant.truth.name} does not come to rest at {np.rad2deg(q)} deg: its springs or "
            "dampers are too small; correct the plant file"
        )
    acceleration, tilt = sensor_rows(plant, at, mounting)
    sensed = acceleration @ A[n : 2 * n, :]
    sensed[:, :n] += tilt
    return SmallMotion(
        at=at,
        mass=terms.M,
        damping=terms.C,
        stiffness=terms.K,
        state_matrix=A,
        poles=poles.astype(np.complex128),
        modes=modes.astype(np.complex128),
        inverse_modes=np.linalg.inv(modes).astype(np.complex128),
        sensed=sensed,
        sensed_direct=acceleration @ np.linalg.inv(terms.M),
        elements=tuple(terms.elements),
    )


def state_matrix(terms: LinearTerms) -> Array:
    """(s, s) A of x' = A x without force, x = (q, q', z)."""
    n, m = len(terms.labels), len(terms.maxwell)
    A = np.zeros((2 * n + m, 2 * n + m))
    A[:n, n : 2 * n] = np.eye(n)
    K, pull = terms.K.copy(), np.zeros((n, m))
    for i, element in enumerate(terms.maxwell):
        K += element.k * np.outer(element.row, element.row)
        pull[:, i] = element.k * element.row
        A[2 * n + i, :n] = element.rate_rad_s * element.row
        A[2 * n + i, 2 * n + i] = -element.rate_rad_s
    A[n : 2 * n] = np.linalg.solve(terms.M, np.hstack((-K, -terms.C, pull)))
    return A


def _columns(plant: Plant, J: Array) -> Array:
    """Columns of the coordinates out of those of all hinges; effects' own move no point."""
    result = np.zeros((len(J), len(plant.coordinates)))
    result[:, : len(plant.springs)] = J[:, list(plant.springs)]
    return result


def sensor_rows(plant: Plant, at: Placement, mounting: Mounting | None) -> tuple[Array, Array]:
    """Specific force in sensor axes per acceleration and per turn of coordinates, (3, n) each.

    An accelerometer feels a - g in axes that turn with it. To first order the change of that is
    R^T (a + theta x g). On a base that stands still it feels a small part of the motion of the
    first link's far end, which the floor lets through.
    """
    n = len(plant.coordinates)
    if mounting is None:
        return np.zeros((3, n)), np.zeros((3, n))
    point = plant.point(mounting.point_id)
    if point.body == BASE:
        body = plant.joints[1] if len(plant.joints) > 1 else plant.joints[0]
        J = _columns(plant, point_jacobian(at, max(body - 1, 0), at.hinge_m[body]))
        share = plant.truth.accelerometer.base_motion
        return share * mounting.R_link_sensor.T @ J[:3], np.zeros((3, n))
    J = _columns(
        plant,
        point_jacobian(
            at, point.body, at.origin_m[point.body] + at.R[point.body] @ point.position_m
        ),
    )
    R_sensor_base = (at.R[point.body] @ mounting.R_link_sensor).T
    tilt = R_sensor_base @ -skew(plant.chain.gravity_m_s2) @ J[3:]
    return R_sensor_base @ J[:3], tilt
