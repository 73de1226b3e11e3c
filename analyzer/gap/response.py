"""FRFs of a system on its lines, and their derivatives; several postures at once.

With H(s) the receptance of the coordinates without the accelerometer, b the generalised force of a
unit hit, U the motion of the accelerometer's place and m its mass, the accelerometer changes the
motion to

    x = E H b,    E = I - H U S U',    S = m s^2 (I + m s^2 U' H U)^-1 ,

so that one inverse serves all mountings of a posture. o x with o = s^2 o_v + o_g is the recorded
acceleration, tilt of gravity included, and for any parameter

    d(o x) = do x - (o E H) dZ x + (o E H) db ,        Z = H^-1 + m s^2 U U' .

A loss factor eta is causal, constant at every frequency, and leaves k as it is at a reference:

    k (1 + eta L(s)),    L(s) = (2 / pi) ln(s / w_r),    L(i w) = i + (2 / pi) ln(w / w_r) .

A compliance gamma with loss tau changes H by w w' d(gamma / (1 + tau s)), w the motion per unit
torque inside that compliance: also at gamma = 0.

Axes of arrays: P postures, L lines, m mountings, n coordinates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from analyzer.gap.assembly import System
from analyzer.gap.systems import MotionSlopes, Slopes

__all__ = ["Response", "applied", "hysteresis", "lines_last", "of_hits", "respond"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


_REFERENCE_RAD_S = 2.0 * np.pi * 30.0  # at which a joint with a loss factor has its stiffness k


def hysteresis(s: ComplexArray) -> ComplexArray:
    """What a unit loss factor adds to a unit stiffness at s, in rad/s."""
    return np.asarray((2.0 / np.pi) * np.log(s / _REFERENCE_RAD_S))


@dataclass(frozen=True, kw_only=True)
class Response:
    """Solution of systems on their lines; what only derivatives need is solved when asked for."""

    system: System  # of P postures
    s_rad_s: ComplexArray  # (P, L)
    hit: npt.NDArray[np.int64]  # (P, m) index into the system's hits
    factor: ComplexArray  # (P, L) of all channels: scale and delay
    x: ComplexArray  # (P, L, m, n) motion under the hit
    true_axes: ComplexArray  # (P, L, m, 3) before channels were mixed, factor included
    inner: ComplexArray  # (P, L, n, n) A^-1: column i is w of coordinate i
    H: ComplexArray  # (P, L, n, n) receptance without the accelerometer
    HU: ComplexArray  # (P, L, m, 3, n) rows H U
    S: ComplexArray  # (P, L, m, 3, 3)

    @cached_property
    def under_loads(self) -> ComplexArray:
        """(P, L, m, 3, n) motion under unit loads on the recorded axes, factor included.

        Along the recorded channels, so that their mixing is inside.
        """
        system = self.system
        P, L, m, n = self.x.shape
        s2 = (self.s_rad_s**2)[:, :, None, None]
        seen, tilted = (
            (system.mix @ of).reshape(P, 1, m * 3, n) for of in (system.seen, system.tilted)
        )
        Y0 = np.matmul(s2 * seen + tilted, self.H).reshape(P, L, m, 3, n)
        U_turned = system.moved[:, None].swapaxes(-1, -2)
        Y = Y0 - np.matmul(np.matmul(np.matmul(Y0, U_turned), self.S), self.HU)
        return np.asarray(Y * self.factor[:, :, None, None, None])

    @cached_property
    def by_line(self) -> tuple[ComplexArray, ComplexArray]:
        """`x` as (P, n, m, L) and `under_loads` as (P, n, m, 3, L): derivatives are such."""
        return (
            np.ascontiguousarray(self.x.transpose(0, 3, 2, 1)),
            np.ascontiguousarray(self.under_loads.transpose(0, 4, 2, 3, 1)),
        )

    @property
    def values(self) -> ComplexArray:
        """(P, m, 3, L) accelerance as recorded."""
        return lines_last(applied(self.system.mix[:, None], self.true_axes))

    def by_stretch(self, row: Array, weight: ComplexArray | Array) -> ComplexArray:
        """Derivative by a spring (weight 1) or a damper (weight s) that stretches by row . x.

        `row` (P, n), `weight` (P, L).
        """
        at = np.flatnonzero(np.any(row, axis=0))
        x, Y = self.by_line
        load = np.asarray(sum(Y[:, i] * row[:, i, None, None, None] for i in at))
        stretch = np.asarray(sum(x[:, i] * -row[:, i, None, None] for i in at))
        return np.asarray(load * (stretch * weight[:, None, :])[:, :, None])

    def by_term(self, kind: str, i: int, j: int) -> ComplexArray:
        """Derivative by an element of "mass", "damping", "stiffness" or "loss"."""
        x, Y = self.by_line
        return np.asarray(Y[:, i] * (x[:, j] * -self.weight(kind)[:, None, :])[:, :, None])

    def by_stretch_of(self, kind: str, row: Array) -> ComplexArray:
        """Derivative by a spring ("stiffness") or damper ("damping"); row (P, n)."""
        return self.by_stretch(row, self.weight(kind))

    def weight(self, kind: str) -> ComplexArray:
        """Return (P, L) what "mass", "damping", "stiffness" or "loss" is multiplied by in Z."""
        s = self.s_rad_s
        return {"mass": s**2, "damping": s, "stiffness": np.ones_like(s), "loss": hysteresis(s)}[
            kind
        ]

    def by_compliances(self, coordinates: Sequence[int]) -> ComplexArray:
        """Derivatives (k, P, m, 3, L) by the compliances of k coordinates.

        H has the compliance as a factor on both sides: where none is zero that is divided out.
        """
        gamma = self.system.compliance[:, list(coordinates)]
        found = np.empty((len(coordinates), *self._shape), dtype=np.complex128)
        locked = [i for i, column in enumerate(gamma.T) if not column.all()]
        if locked:
            left, right = self.through_compliances([coordinates[i] for i in locked])
            found[locked] = left * right[:, :, :, None]
        s, loss_s = self.s_rad_s, self.system.compliance_loss_s
        x, Y = self.by_line
        for i, at in enumerate(coordinates):
            if i not in locked:
                weight = (1.0 + loss_s[:, at, None] * s) / gamma[:, i, None] ** 2
                np.multiply(Y[:, at], (x[:, at] * weight[:, None, :])[:, :, None], out=found[i])
        return found

    @property
    def _shape(self) -> tuple[int, ...]:
        P, L, m, _ = self.x.shape
        return P, m, 3, L

    def through_compliances(self, coordinates: Sequence[int]) -> tuple[ComplexArray, ComplexArray]:
        """What is recorded of a unit yield, and the torque that a unit hit puts there.

        Returns
        -------
        recorded : (k, P, m, 3, L), torque : (k, P, m, L), the compliance's own lag included
        """
        system, s = self.system, self.s_rad_s
        P, L, m, n = self.x.shape
        w = self.inner[..., list(coordinates)]  # (P, L, n, k)

        def through(rows: Array) -> ComplexArray:
            """(P, L, m, 3, k)."""
            return np.asarray(np.matmul(rows.reshape(P, 1, m * 3, n), w).reshape(P, L, m, 3, -1))

        s2 = (s**2)[:, :, None, None, None]
        o_w = s2 * through(system.seen) + through(system.tilted)
        HU = self.HU.swapaxes(-1, -2)
        o_HU = s2 * np.matmul(system.seen[:, None], HU) + np.matmul(system.tilted[:, None], HU)
        SUw = np.matmul(self.S, through(system.moved))
        o_w = np.matmul(system.mix[:, None], o_w - np.matmul(o_HU, SUw))
        b = self._forces()  # (P, m, n)
        b_HU = np.matmul(self.HU, b[:, None, ..., None]).swapaxes(-1, -2)  # (P, L, m, 1, 3)
        w_b = np.matmul(b[:, None], w) - np.matmul(b_HU, SUw)[..., 0, :]  # (P, L, m, k)
        lag = 1.0 / (1.0 + system.compliance_loss_s[:, None, list(coordinates)] * s[..., None])
        torque = w_b * (self.factor[..., None] * lag)[:, :, None, :]
        return o_w.transpose(4, 0, 2, 3, 1), torque.transpose(3, 0, 2, 1)

    def _forces(self) -> Array:
        """(P, m, n) generalised force of the hit of each mounting."""
        return of_hits(_hit_forces(self.system), self.hit)

    def by_link_inertia(self, link: int, changes: Array) -> ComplexArray:
        """Derivatives (k, P, m, 3, L) by k changes (k, 6, 6) of a link's spatial inertia.

        Gravity's stiffness is taken as it is: its part is far below the inertia's own.
        """
        pieces = self.system.pieces.get(link)
        if pieces is None:
            return self._by_inertia(self.system.link_motion[:, link], changes)
        split = np.stack([pieces.split(change) for change in changes], axis=1)
        motions = pieces.motion.swapaxes(0, 1)  # (pieces, P, 6, n)
        parts = [self._by_inertia(J, own) for J, own in zip(motions, split, strict=True)]
        return np.asarray(np.sum(parts, axis=0))

    def _by_inertia(self, J: Array, changes: Array) -> ComplexArray:
        """`J` (P, 6, n)."""
        P, m, _, L = shape = self._shape
        x, Y = self.by_line
        V = _real_times(J, x).reshape(P, 6, m, L) * -(self.s_rad_s**2)[:, None, None, :]
        W = _real_times(J, Y).reshape(P, 6, m, 3, L)
        products = W[:, :, None] * V[:, None, :, :, None]  # (P, 6, 6, m, 3, L)
        y = _real_times(changes.reshape(-1, 36), products.reshape(P, 36, -1))
        return np.asarray(y.reshape(P, -1, *shape[1:]).swapaxes(0, 1))

    def by_force(self, hit: int, change: Array) -> ComplexArray:
        """Derivative by the force's components (P, 3) of one hit."""
        b = (change[:, None] @ self.system.hit[:, hit])[:, 0]  # (P, n)
        mine = (self.hit == hit).astype(np.float64)
        return lines_last(applied(self.under_loads, b[:, None, None]) * mine[:, None, :, None])

    def by_shift(self) -> ComplexArray:
        """Derivatives (3, P, m, 3, L) by a shift of each mounting along its own sensor's axes.

        The accelerometer's mass is taken to stay where it is.
        """
        turn = applied(self.system.turned[:, None], self.x)  # (P, L, m, 3)
        scale = (self.factor * self.s_rad_s**2)[:, :, None, None]
        moved = [np.cross(turn, axis) * scale for axis in np.eye(3)]
        return np.stack([lines_last(applied(self.system.mix[:, None], a)) for a in moved])

    def by_slopes(self, slopes: Slopes) -> ComplexArray:
        """Derivatives (k, P, m, 3, L) by the k joint angles; slopes of P postures."""
        system = self.system
        P, L, m, n = self.x.shape
        k = slopes.mass.shape[1]
        s2 = (self.s_rad_s**2)[:, None, :, None, None]  # (P, 1, L, 1, 1)
        x = self.x.swapaxes(1, 2)  # (P, m, L, n)
        parts = np.concatenate([x.real, x.imag], axis=2)  # BLAS takes no parts where they lie

        def of_motion(rows: Array) -> ComplexArray:
            """(P, m, L, j) of real rows (P, m or 1, n, j)."""
            found = np.matmul(parts, rows)
            return np.asarray(found[:, :, :L] + 1j * found[:, :, L:])

        mix = system.mix[:, None]
        seen = [slopes.moved, mix @ slopes.seen, mix @ slopes.tilted]  # (P, k, m, 3, n) each
        rows = np.concatenate([by.transpose(0, 2, 4, 1, 3).reshape(P, m, n, -1) for by in seen], -1)
        moved, shown, tilted = of_motion(rows).reshape(P, m, L, 3, k, 3).transpose(3, 0, 1, 2, 4, 5)
        by_mass = slopes.mass.transpose(0, 3, 1, 2).reshape(P, 1, n, k * n)
        pull = s2 * of_motion(by_mass).reshape(P, m, L, k, n)
        if system.sensor_mass_kg.any():
            U, dU = system.moved, slopes.moved
            load = _times(moved.reshape(P, m, L * k, 3), U).reshape(P, m, L, k, n)
            still = of_motion(U.swapaxes(2, 3))  # (P, m, L, 3)
            by_still = dU.transpose(0, 2, 3, 1, 4).reshape(P, m, 3, k * n)
            load += _times(still, by_still).reshape(P, m, L, k, n)
            pull += system.sensor_mass_kg[:, None, None, None, None] * s2 * load
        push = np.einsum("pha,pkhan->phkn", system.force, slopes.hit)
        pull -= of_hits(push, self.hit)[:, :, None]
        y = -np.matmul(pull, self.under_loads.transpose(0, 2, 1, 4, 3))  # (P, m, L, k, 3)
        y += self.factor[:, None, :, None, None] * (s2 * shown + tilted)
        return np.asarray(y.transpose(3, 0, 1, 4, 2))

    def by_motion(self, slopes: MotionSlopes) -> ComplexArray:
        """Derivatives (k, P, m, 3, L) by k parameters with which a coordinate moves otherwise."""
        system, at, k = self.system, slopes.at, len(slopes.at)
        x, Y = self.by_line
        s2 = (self.s_rad_s**2)[:, None, None]  # (P, 1, 1, L)
        mass_kg = system.sensor_mass_kg[:, None, None, None]
        inertia = slopes.mass[:, None] + mass_kg * (slopes.moved.swapaxes(2, 3) @ system.moved)

        def through(spring: Array, of: ComplexArray) -> ComplexArray:
            """(P, m, k, ..., L) of inertia and spring with what (P, m, n, ..., L) moves."""
            rows = np.concatenate([inertia, np.broadcast_to(spring[:, None], inertia.shape)], 2)
            P, m, n = of.shape[:3]
            flat = np.ascontiguousarray(of).reshape(P, m, n, -1).view(np.float64)
            both = np.matmul(rows, flat).view(np.complex128).reshape(P, m, 2 * k, *of.shape[3:])
            weight = s2 if of.ndim == 4 else s2[..., None, :]
            return np.asarray(weight * both[:, :, :k] + both[:, :, k:])

        push = np.einsum("pha,phak->phk", system.force, slopes.hit)
        pull = through(slopes.stiffness_row, x.swapaxes(1, 2)) - of_hits(push, self.hit)[..., None]
        load = through(slopes.stiffness_column, Y.swapaxes(1, 2))  # (P, m, k, 3, L)
        seen, tilted = (
            (system.mix @ of).swapaxes(2, 3)[..., None] for of in (slopes.seen, slopes.tilted)
        )
        load -= self.factor[:, None, None, None] * (s2[..., None, :] * seen + tilted)
        y = Y[:, at] * pull.swapaxes(1, 2)[:, :, :, None]
        y += load.swapaxes(1, 2) * x[:, at][:, :, :, None]
        return np.asarray(-y.swapaxes(0, 1))


def applied(matrix: ComplexArray | Array, vector: ComplexArray | Array) -> ComplexArray:
    """Matrices (..., a, b) times vectors (..., b)."""
    return np.asarray(np.matmul(matrix, vector[..., None])[..., 0])


def _real_times(real: Array, z: ComplexArray) -> ComplexArray:
    """Real (..., k, n) by complex (P, n, ...), contiguous: (P, k, all the rest)."""
    P, n = z.shape[:2]
    return np.asarray(np.matmul(real, z.reshape(P, n, -1).view(np.float64)).view(np.complex128))


def _times(z: ComplexArray, real: Array) -> ComplexArray:
    """Complex (..., k, n) by real (..., n, j) matrices."""
    found = np.empty(
        (*np.broadcast_shapes(z.shape[:-2], real.shape[:-2]), z.shape[-2], real.shape[-1]),
        dtype=np.complex128,
    )
    # Copies: BLAS takes no parts of complex numbers where they lie.
    found.real = np.matmul(np.ascontiguousarray(z.real), real)
    found.imag = np.matmul(np.ascontiguousarray(z.imag), real)
    return found


def _rows(of: Array, H: ComplexArray) -> ComplexArray:
    """(P, L, m, 3, n) of (P, m, 3, n) on the left of H."""
    P, m, _, n = of.shape
    return np.asarray(np.matmul(of.reshape(P, 1, m * 3, n), H).reshape(P, -1, m, 3, n))


def lines_last(y: ComplexArray) -> ComplexArray:
    """(P, L, m, 3) to (P, m, 3, L)."""
    return np.asarray(y.transpose(0, 2, 3, 1))


def of_hits(by_hit: Array, hit: npt.NDArray[np.int64]) -> Array:
    """(P, n_hits, ...) to (P, m, ...): each mounting's own hit."""
    if by_hit.shape[1] == 1:
        return np.broadcast_to(by_hit, (*hit.shape, *by_hit.shape[2:]))
    return np.asarray(by_hit[np.arange(len(hit))[:, None], hit])


def _hit_forces(system: System) -> Array:
    """(P, n_hits, n) generalised forces."""
    return np.asarray((system.force[:, :, None] @ system.hit)[:, :, 0])


def _inverse(M: ComplexArray) -> ComplexArray:
    """Inverses of matrices (..., 3, 3), by cross products of their rows."""
    a, b, c = M[..., 0, :], M[..., 1, :], M[..., 2, :]
    columns = np.stack([_cross(b, c), _cross(c, a), _cross(a, b)], axis=-1)
    return np.asarray(columns / np.sum(a * columns[..., 0], axis=-1)[..., None, None])


def _cross(a: ComplexArray, b: ComplexArray) -> ComplexArray:
    return np.stack(
        [a[..., i] * b[..., j] - a[..., j] * b[..., i] for i, j in ((1, 2), (2, 0), (0, 1))],
        axis=-1,
    )


def respond(system: System, s_rad_s: ComplexArray, hit: npt.NDArray[np.int64]) -> Response:
    """Solve systems of P postures on their lines, as far from them as a hidden window moved them.

    `s_rad_s` (P, L), `hit` (P, m): each mounting's, index into the system's.
    """
    s = s_rad_s + system.decay_rad_s[:, None]
    soft = np.isfinite(system.compliance[0])
    gamma = np.where(soft, system.compliance, 1.0)[:, None]
    loss_s = system.compliance_loss_s[:, None]
    scale = np.where(soft, gamma / (1.0 + s[..., None] * loss_s), 1.0)  # (P, L, n)
    by_line = s[..., None, None]
    Z = (
        by_line**2 * system.mass[:, None]
        + by_line * system.damping[:, None]
        + system.stiffness[:, None]
        + hysteresis(by_line) * system.loss[:, None]
    )
    A = scale[..., None] * Z
    A[..., soft, soft] += 1.0
    inner = np.linalg.inv(A)
    H = inner * scale[:, :, None, :]  # symmetric
    U = system.moved  # (P, m, 3, n)
    HU = _rows(U, H)
    ms2 = (system.sensor_mass_kg[:, None] * s**2)[:, :, None, None, None]
    S = ms2 * _inverse(np.eye(3) + ms2 * np.matmul(HU, U[:, None].swapaxes(-1, -2)))
    by_hit = np.matmul(_hit_forces(system)[:, None], H)  # (P, L, n_hits, n)
    x0 = of_hits(by_hit.swapaxes(1, 2), hit).swapaxes(1, 2)  # (P, L, m, n)
    SUx = applied(S, applied(U[:, None], x0))
    x = x0 - np.matmul(SUx[..., None, :], HU)[..., 0, :]
    factor = np.exp(system.log_scale[:, None] - s * system.delay_s[:, None])
    raw = by_line**2 * applied(system.seen[:, None], x) + applied(system.tilted[:, None], x)
    return Response(
        system=system,
        s_rad_s=s,
        hit=hit,
        factor=factor,
        x=x,
        true_axes=raw * factor[:, :, None, None],
        inner=inner,
        H=H,
        HU=HU,
        S=S,
    )
