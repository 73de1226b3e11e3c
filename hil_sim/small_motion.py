"""Small motion of the arm about a held posture: M q'' + C q' + (K + dg/dq) q = J^T f.

The mass matrix is frozen at the posture; `docs/simulated-plant.md` gives what that costs beside the
full equations. The servos hold the gravity torque, so the springs' rest is the posture itself and
gravity leaves only its stiffness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil_sim.newton_euler import (
    Placement,
    gravity_stiffness,
    mass_matrix,
    place,
    point_jacobian,
    skew,
    with_point_mass,
)
from hil_sim.plant import BASE, Plant
from protocols.errors import PlantError

__all__ = ["Mounting", "SmallMotion", "linearise"]

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

    With n springs the state is (q, q') of length 2 n; `modes` holds the right eigenvectors in its
    columns and `inverse_modes` is its inverse.
    """

    at: Placement
    mass: Array  # (n, n) kg m^2
    damping: Array  # (n, n) N m s / rad
    stiffness: Array  # (n, n) N m / rad, gravity included
    poles: ComplexArray  # (2 n,) rad/s
    modes: ComplexArray  # (2 n, 2 n)
    inverse_modes: ComplexArray  # (2 n, 2 n)
    sensed: Array  # (3, 2 n) specific force in sensor axes per unit state
    sensed_direct: Array  # (3, n) the same per unit of torque

    def natural_frequencies_hz(self) -> Array:
        """|pole| / 2 pi of the oscillating modes, ascending."""
        return self._oscillating()[0]

    def damping_ratios(self) -> Array:
        """-Re(pole) / |pole| of the oscillating modes, in the order of the frequencies."""
        return self._oscillating()[1]

    def _oscillating(self) -> tuple[Array, Array]:
        upper = self.poles[self.poles.imag > 0.0]
        upper = upper[np.argsort(np.abs(upper))]
        return np.abs(upper) / (2.0 * np.pi), -upper.real / np.abs(upper)

    def residues(self, torque: Array) -> tuple[ComplexArray, Array]:
        """Transfer from a force to the sensor in partial fractions.

        Parameters
        ----------
        torque
            (n,) torque at the springs per newton of the force.

        Returns
        -------
        residues, direct
            (3, 2 n) residues at `poles`, m/s^2 per N times rad/s, and (3,) the direct part,
            m/s^2 per N.
        """
        n = self.mass.shape[0]
        drive = np.zeros(2 * n)
        drive[n:] = np.linalg.solve(self.mass, torque)
        residues = (self.sensed @ self.modes) * (self.inverse_modes @ drive)
        return residues, self.sensed_direct @ torque


def force_torque(plant: Plant, at: Placement, body: int, position_m: Array, force: Array) -> Array:
    """Torque (n_springs,) in N m of a force (base axes) on a point fixed in a body's frame."""
    if body == BASE:
        return np.zeros(len(plant.springs))
    point = at.origin_m[body] + at.R[body] @ position_m
    J = point_jacobian(at, body, point)
    torque: Array = J[:3, list(plant.springs)].T @ force
    return torque


def linearise(plant: Plant, joints_rad: npt.ArrayLike, mounting: Mounting | None) -> SmallMotion:
    """Linearise the arm about a posture, with the accelerometer's mass where it sits.

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
        mass_kg = plant.truth.accelerometer.mass_kg
        chain = with_point_mass(chain, point.body, point.position_m, mass_kg)
    free = np.ix_(plant.springs, plant.springs)
    M = mass_matrix(chain, q)[free]
    C = np.diag(plant.damping)
    K = np.diag(plant.stiffness) + gravity_stiffness(chain, q)[free]
    n = len(plant.springs)
    A = np.zeros((2 * n, 2 * n))
    A[:n, n:] = np.eye(n)
    A[n:, :n] = -np.linalg.solve(M, K)
    A[n:, n:] = -np.linalg.solve(M, C)
    poles, modes = np.linalg.eig(A)
    if np.any(poles.real >= 0.0):
        raise PlantError(
            f"{plant.truth.name} does not come to rest at {np.rad2deg(q)} deg: its springs or "
            "dampers are too small; correct the plant file"
        )
    acceleration, tilt = _sensor_rows(plant, at, mounting)
    sensed = acceleration @ A[n:, :]
    sensed[:, :n] += tilt
    return SmallMotion(
        at=at,
        mass=M,
        damping=C,
        stiffness=K,
        poles=poles.astype(np.complex128),
        modes=modes.astype(np.complex128),
        inverse_modes=np.linalg.inv(modes).astype(np.complex128),
        sensed=sensed,
        sensed_direct=acceleration @ np.linalg.inv(M),
    )


def _sensor_rows(plant: Plant, at: Placement, mounting: Mounting | None) -> tuple[Array, Array]:
    """Specific force in sensor axes per hinge acceleration and per hinge angle, (3, n) each.

    An accelerometer feels a - g in axes that turn with it. To first order the change of that is
    R^T (a + theta x g). On the base it feels a small part of the motion of the first link's
    far end, which the floor lets through.
    """
    n = len(plant.springs)
    if mounting is None:
        return np.zeros((3, n)), np.zeros((3, n))
    point = plant.point(mounting.point_id)
    springs = list(plant.springs)
    if point.body == BASE:
        body = plant.joints[1] if len(plant.joints) > 1 else plant.joints[0]
        J = point_jacobian(at, max(body - 1, 0), at.hinge_m[body])
        share = plant.truth.accelerometer.base_motion
        return share * mounting.R_link_sensor.T @ J[:3, springs], np.zeros((3, n))
    J = point_jacobian(
        at, point.body, at.origin_m[point.body] + at.R[point.body] @ point.position_m
    )
    R_sensor_base = (at.R[point.body] @ mounting.R_link_sensor).T
    tilt = R_sensor_base @ -skew(plant.chain.gravity_m_s2) @ J[3:, springs]
    return R_sensor_base @ J[:3, springs], tilt
