"""A model at rest, linearised by differences of MuJoCo's own forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import mujoco
import numpy as np
import numpy.typing as npt
import scipy

from armodal.hil_sim.makers.arm_table import Array
from armodal.hil_sim.makers.mujoco.compiled import Compiled

__all__ = ["SmallSignal", "frequencies_hz", "ring_linear", "small_signal"]

STEP_RAD = 1e-6  # of the differences: round-off and curvature both below 1e-8 of the stiffness

Complex = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class SmallSignal:
    """M a + C v + K q = force, each (n, n)."""

    M: Array
    C: Array
    K: Array

    def with_mass(self, mass_kg: float, J: Array) -> SmallSignal:
        """Carry a point mass where the Jacobian (3, n) is."""
        return SmallSignal(M=self.M + mass_kg * J.T @ J, C=self.C, K=self.K)

    def receptance(self, s: Complex, loads: Array) -> Complex:
        """Generalised displacement, (lines, n, k), of loads (n, k) at lines s."""
        lines = s[:, None, None]
        Z = self.M * lines**2 + self.C * lines + self.K
        return np.asarray(np.linalg.solve(Z, loads + 0j), dtype=np.complex128)


def small_signal(here: Compiled) -> SmallSignal:
    """Linearise about rest.

    Raises
    ------
    ValueError
        If constraints act: dry friction has no linear law.
    """
    model, data = here.model, here.data
    if data.nefc:
        raise ValueError("wanted a model without constraints, got dry friction or contacts")
    n = model.nv
    M = np.zeros((n, n))
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, M)
    M += np.diag(np.zeros(n))
    K, C = np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        K[:, i] = _slope(model, data, data.qpos, i)
        C[:, i] = _slope(model, data, data.qvel, i)
    mujoco.mj_forward(model, data)
    return SmallSignal(M=M, C=C, K=K)


def _slope(model: mujoco.MjModel, data: mujoco.MjData, state: Array, i: int) -> Array:
    forces = []
    for sign in (1.0, -1.0):
        state[i] = sign * STEP_RAD
        mujoco.mj_forward(model, data)
        forces.append(data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias)
    state[i] = 0.0
    return cast("Array", -(forces[0] - forces[1]) / (2.0 * STEP_RAD))


def frequencies_hz(system: SmallSignal) -> Array:
    """Undamped natural frequencies, ascending."""
    squared = np.linalg.eigvals(np.linalg.solve(system.M, system.K)).real
    return cast("Array", np.sqrt(np.sort(squared)) / (2.0 * np.pi))


def ring_linear(
    system: SmallSignal, load: Array, force_n: Array, rate_hz: float
) -> tuple[Array, Array]:
    """Acceleration and displacement, each (samples, n), under one load's time history.

    Between samples the force is a straight line, for which the modes' recursion is exact
    (first-order hold; Franklin, Powell, Workman, Digital Control of Dynamic Systems, section 4.3).
    """
    n, h = len(load), 1.0 / rate_hz
    inverse = np.linalg.inv(system.M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ system.K, -inverse @ system.C]])
    poles, shapes = np.linalg.eig(A)
    into = np.linalg.solve(shapes, np.concatenate([np.zeros(n), inverse @ load]) + 0j)
    grown = np.exp(poles * h)
    late = (grown - 1.0 - poles * h) / (poles**2 * h)  # weight of the sample to come
    early = (grown - 1.0) / poles - late
    modal = np.empty((len(force_n), 2 * n), dtype=np.complex128)
    for i in range(2 * n):
        modal[:, i] = scipy.signal.lfilter([late[i], early[i]], [1.0, -grown[i]], force_n) * into[i]
    state = (modal @ shapes.T).real
    acceleration = state @ A[n:].T + np.outer(force_n, inverse @ load)
    return acceleration, state[:, :n]
