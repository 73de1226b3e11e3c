"""Motion of an arm with one hinge that is stiff on one side only: linear, piece by piece.

Closed, x' = A x + b f. Beyond the opening angle the hinge's torque loses (k_closed - k_open)
(phi - opening), which makes another linear system with a constant push. Within a piece the motion
is a sum of exponentials and known exactly; the hinge changes sides on the fine grid, at the first
step beyond the crossing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil_sim.plant import Plant
from hil_sim.small_motion import SmallMotion

__all__ = ["one_sided_response"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

BLOCK = 256  # fine steps looked at together


@dataclass(frozen=True, slots=True)
class _Side:
    """x = rest + V e^(L t) V^-1 (x0 - rest), and what the sensor feels."""

    rest: Array  # (s,)
    V: ComplexArray
    V_inverse: ComplexArray
    step: Array  # (s, s) over one fine step
    drive: Array  # (s, 2) of the force at the step's beginning and end
    powers: ComplexArray  # (s, BLOCK) e^(L T (k + 1))
    sensed: Array  # (3, s)
    bias: Array  # (3,)


def one_sided_response(
    plant: Plant, motion: SmallMotion, torque: Array, force: Array, fine_hz: float, n: int
) -> Array:
    """Specific force (n, 3) at the sensor, from rest, force zero after its last entry.

    Parameters
    ----------
    torque
        (n_coordinates,) torque per newton.
    """
    crack = plant.one_sided
    if crack is None:
        raise ValueError("wanted a plant with a one-sided hinge, got one without")
    hinge = plant.coordinates.index(crack.hinge)
    lost = float(plant.stiffness[hinge]) - crack.k_open
    sides = [
        _side(motion, torque, hinge, stiffness_lost, crack.opening_rad, fine_hz)
        for stiffness_lost in (0.0, lost)
    ]
    felt = np.zeros((n, 3))
    x = np.zeros(len(motion.poles))
    direct = motion.sensed_direct @ torque
    driven = min(len(force), n)
    felt[:driven] = np.outer(force[:driven], direct)
    for i in range(driven):
        side = sides[int(x[hinge] > crack.opening_rad)]
        felt[i] += side.sensed @ x + side.bias
        if i + 1 < driven:
            x = side.rest + side.step @ (x - side.rest) + side.drive @ force[i : i + 2]
    done = driven
    while done < n:
        is_open = bool(x[hinge] > crack.opening_rad)
        side = sides[int(is_open)]
        amplitudes = side.V_inverse @ (x - side.rest)
        phi = side.rest[hinge] + ((side.V[hinge] * amplitudes) @ side.powers).real
        left = np.flatnonzero((phi > crack.opening_rad) != is_open)
        steps = min(int(left[0]) + 1 if len(left) else BLOCK, n - done)
        rows = (side.sensed @ side.V) * amplitudes
        felt[done : done + steps] = (rows @ side.powers[:, :steps]).real.T + (
            side.sensed @ side.rest + side.bias
        )
        x = side.rest + (side.V @ (side.powers[:, steps - 1] * amplitudes)).real
        done += steps
    return felt


def _side(
    motion: SmallMotion, torque: Array, hinge: int, lost: float, opening_rad: float, fine_hz: float
) -> _Side:
    """The linear system with `lost` of the hinge's stiffness beyond the opening."""
    n = len(motion.mass)
    A = motion.state_matrix.copy()
    push = np.zeros(len(A))
    push[n : 2 * n] = np.linalg.inv(motion.mass)[:, hinge]
    A[:, hinge] += lost * push
    rest = np.linalg.solve(A, push * lost * opening_rad)
    b = np.zeros(len(A))
    b[n : 2 * n] = np.linalg.solve(motion.mass, torque)
    poles, V = np.linalg.eig(A)
    V_inverse = np.linalg.inv(V)
    T = 1.0 / fine_hz
    a = poles * T
    ramp, whole = (np.exp(a) - 1.0 - a) / a**2, (np.exp(a) - 1.0) / a
    modal = V_inverse @ b
    drive = np.column_stack(
        [(V @ (modal * T * (whole - ramp))).real, (V @ (modal * T * ramp)).real]
    )
    # The sensor's rows hold acceleration = A x + push; what the opened hinge adds goes the same way.
    extra = motion.sensed_direct[:, hinge] * lost
    sensed = motion.sensed.copy()
    sensed[:, hinge] += extra
    return _Side(
        rest=rest,
        V=V.astype(np.complex128),
        V_inverse=V_inverse.astype(np.complex128),
        step=(V @ (np.exp(a)[:, None] * V_inverse)).real,
        drive=drive,
        powers=np.exp(np.outer(a, np.arange(1, BLOCK + 1))).astype(np.complex128),
        sensed=sensed,
        bias=-extra * opening_rad,
    )
