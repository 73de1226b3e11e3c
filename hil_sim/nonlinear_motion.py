"""Motion with nonlinear elements: exact for the linear part, implicit in the elements' torques.

Of M q'' + C q' + K q + sum_e row_e g_e(row_e q) = torque f every mode
a' = p a + b f - sum_e b_e g_e is advanced exactly for drives that are linear between grid points
(first-order hold). The stretches at the next grid point follow from their own torques there,
s = s_free - S g(s), which Newton's method solves; the elements' laws are piecewise smooth in s.
All hits go in step, since each needs only a few numbers.

References
----------
Hochbruck and Ostermann, Acta Numerica 19 (2010) 209, exponential integrators.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.elements import Element
from armodal.hil_sim.small_motion import SmallMotion

__all__ = ["Drive", "nonlinear_response"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

NEWTON_STEPS = 6
BLOCK = 128  # grid points whose states are kept before the sensor is evaluated


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """One hit: the arm with its sensor, torque (n,) per newton, force on the fine grid."""

    motion: SmallMotion
    torque: Array
    force: Array  # (n_force,), zero after its last entry


@dataclass(slots=True, kw_only=True)
class _Modes:
    """All hits' modes above the real axis, padded with zeros to the same number."""

    decay: ComplexArray  # (h, k) e^(p T)
    drive_old: ComplexArray  # (h, k) of the force at a step's beginning
    drive_new: ComplexArray
    pull_old: ComplexArray  # (h, k, e) of the elements' torques
    pull_new: ComplexArray
    stretch: ComplexArray  # (h, e, k)
    sensed: ComplexArray  # (h, 3, k)
    direct: Array  # (h, 3)
    direct_pull: Array  # (h, 3, e)


def nonlinear_response(drives: Sequence[Drive], fine_hz: float, n: int) -> Array:
    """Specific force (n_hits, n, 3) at the sensors, from rest, on a grid of `fine_hz`.

    The hits' arms must have the same elements.
    """
    elements = drives[0].motion.elements
    modes = _modes(drives, elements, 1.0 / fine_hz)
    h = len(drives)
    state: ComplexArray = np.zeros_like(modes.decay)
    n_force = min(n, max(len(drive.force) for drive in drives))
    force = np.zeros((n_force + 1, h))
    for i, drive in enumerate(drives):
        used = drive.force[:n_force]
        force[: len(used), i] = used
    # Share of its own torque in each stretch at a step's end.
    own = np.einsum("hek,hkf->hef", modes.stretch, modes.pull_new).real
    memory = [np.zeros((h, element.n_memory)) for element in elements]
    torque = np.zeros((h, len(elements)))
    felt = np.empty((h, n, 3))
    kept = np.empty((BLOCK, *state.shape), dtype=np.complex128)
    pulls = np.empty((BLOCK, *torque.shape))
    pulls[0] = 0.0
    kept[0] = state
    filled, done = 1, 0
    for i in range(1, n):
        state *= modes.decay
        for e in range(len(elements)):
            state -= modes.pull_old[:, :, e] * torque[:, e, None]
        if i <= n_force:
            state += modes.drive_old * force[i - 1][:, None]
            state += modes.drive_new * force[i][:, None]
        free = np.stack(
            [np.einsum("hk,hk->h", modes.stretch[:, e], state).real for e in range(len(elements))],
            axis=1,
        )
        s, torque = _balance(elements, memory, free, own, torque)
        for e, element in enumerate(elements):
            state -= modes.pull_new[:, :, e] * torque[:, e, None]
            memory[e] = element.remember(s[:, e], memory[e])
        kept[filled], pulls[filled] = state, torque
        filled += 1
        if filled == BLOCK or i == n - 1:
            swung = modes.sensed @ np.moveaxis(kept[:filled], 0, 2)
            sensed = swung.real - modes.direct_pull @ np.moveaxis(pulls[:filled], 0, 2)
            felt[:, done : done + filled] = np.swapaxes(sensed, 1, 2)
            done += filled
            filled = 0
    if n == 1:
        felt[:] = 0.0
    driven = force[:n_force].T
    felt[:, : driven.shape[1]] += driven[:, :, None] * modes.direct[:, None, :]
    return felt


def _balance(
    elements: Sequence[Element], memory: list[Array], free: Array, own: Array, torque: Array
) -> tuple[Array, Array]:
    """Stretches s = free - own @ g(s) and torques g(s), by Newton's method."""
    s = free - np.einsum("hef,hf->he", own, torque)
    slope = np.empty_like(s)
    torque = np.empty_like(s)
    scale = np.max(np.abs(s)) + 1e-300
    for _ in range(NEWTON_STEPS):
        for e, element in enumerate(elements):
            torque[:, e], slope[:, e] = element.resist(s[:, e], memory[e])
        if len(elements) == 1:
            miss = s - free + own[:, :, 0] * torque
            step = miss / (1.0 + own[:, :, 0] * slope)
        else:
            miss = s - free + np.einsum("hef,hf->he", own, torque)
            matrix = np.eye(len(elements)) + own * slope[:, None, :]
            step = np.linalg.solve(matrix, miss[:, :, None])[:, :, 0]
        s -= step
        if np.max(np.abs(step)) < 1e-9 * scale:
            break
    for e, element in enumerate(elements):
        torque[:, e], _ = element.resist(s[:, e], memory[e])
    return s, torque


def _modes(drives: Sequence[Drive], elements: Sequence[Element], step_s: float) -> _Modes:
    """Modal matrices of every hit for a step."""
    upper = [np.flatnonzero(drive.motion.poles.imag >= 0.0) for drive in drives]
    h, k, n_elements = len(drives), max(len(u) for u in upper), len(elements)
    modes = _Modes(
        decay=np.zeros((h, k), dtype=np.complex128),
        drive_old=np.zeros((h, k), dtype=np.complex128),
        drive_new=np.zeros((h, k), dtype=np.complex128),
        pull_old=np.zeros((h, k, n_elements), dtype=np.complex128),
        pull_new=np.zeros((h, k, n_elements), dtype=np.complex128),
        stretch=np.zeros((h, n_elements, k), dtype=np.complex128),
        sensed=np.zeros((h, 3, k), dtype=np.complex128),
        direct=np.zeros((h, 3)),
        direct_pull=np.zeros((h, 3, n_elements)),
    )
    rows = np.array([element.row for element in elements])
    for i, (drive, index) in enumerate(zip(drives, upper, strict=True)):
        motion, used = drive.motion, slice(0, len(index))
        n = len(motion.mass)
        p = motion.poles[index]
        a = p * step_s
        # Integrals of e^(p (T - t)) times 1 - t/T and t/T.
        whole = (np.exp(a) - 1.0) / a
        new = (np.exp(a) - 1.0 - a) / a**2
        inverse_mass = np.linalg.inv(motion.mass)
        into = motion.inverse_modes[index, n : 2 * n] @ inverse_mass
        push, pulls = into @ drive.torque, into @ rows.T
        twice = np.where(p.imag > 0.0, 2.0, 1.0)
        V = motion.modes[:, index] * twice
        modes.decay[i, used] = np.exp(a)
        modes.drive_old[i, used] = step_s * (whole - new) * push
        modes.drive_new[i, used] = step_s * new * push
        modes.pull_old[i, used] = (step_s * (whole - new))[:, None] * pulls
        modes.pull_new[i, used] = (step_s * new)[:, None] * pulls
        modes.stretch[i, :, used] = rows @ V[:n]
        modes.sensed[i, :, used] = motion.sensed @ V
        modes.direct[i] = motion.sensed_direct @ drive.torque
        modes.direct_pull[i] = motion.sensed_direct @ rows.T
    return modes
