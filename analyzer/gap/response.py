"""FRFs of a system on its lines, and their derivatives.

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
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from analyzer.gap.assembly import System
from analyzer.gap.lines import PostureLines
from analyzer.gap.slopes import Slopes

__all__ = ["Change", "Response", "hysteresis", "respond"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


_REFERENCE_RAD_S = 2.0 * np.pi * 30.0  # at which a joint with a loss factor has its stiffness k


def hysteresis(s: ComplexArray) -> ComplexArray:
    """What a unit loss factor adds to a unit stiffness at s, in rad/s."""
    return np.asarray((2.0 / np.pi) * np.log(s / _REFERENCE_RAD_S))


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """Difference of two systems over a parameter's step; None where nothing changes."""

    mass: Array | None = None
    damping: Array | None = None
    stiffness: Array | None = None
    loss: Array | None = None
    moved: Array | None = None
    seen: Array | None = None
    tilted: Array | None = None
    mix: Array | None = None
    hit: Array | None = None
    force: Array | None = None
    sensor_mass_kg: float | None = None

    @classmethod
    def between(cls, before: System, after: System, step: float) -> Change:
        """Change a unit of the parameter makes."""
        found: dict[str, Any] = {}
        for name in cls.__slots__:
            old, new = getattr(before, name), getattr(after, name)
            if old is not new and not np.array_equal(old, new):
                found[name] = (new - old) / step
        return cls(**found)


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """Solution of a system on its lines; L lines, m mountings, n coordinates."""

    system: System
    lines: PostureLines
    factor: ComplexArray  # (L,) of all channels: scale and delay
    x: ComplexArray  # (L, m, n) motion under the hit
    Y: ComplexArray  # (L, m, 3, n) motion under unit loads on the recorded axes, factor included
    true_axes: ComplexArray  # (L, m, 3) before channels were mixed, factor included
    inner: ComplexArray  # (L, n, n) A^-1: column i is w of coordinate i
    HU: ComplexArray  # (L, m, 3, n) rows H U
    S: ComplexArray  # (L, m, 3, 3)

    @property
    def values(self) -> ComplexArray:
        """(m, 3, L) accelerance as recorded."""
        return _last(np.matmul(self.system.mix, self.true_axes[..., None])[..., 0])

    def by_stretch(self, row: Array, weight: ComplexArray | float) -> ComplexArray:
        """Derivative by a spring (weight 1) or a damper (weight s) that stretches by row . x."""
        at = np.flatnonzero(row)
        Y = self.Y[..., at] @ row[at]
        x = self.x[:, :, at] @ row[at]
        return _last(-Y * x[:, :, None] * np.reshape(weight, (-1, 1, 1)))

    def by_term(self, kind: str, i: int, j: int) -> ComplexArray:
        """Derivative by an element of "mass", "damping", "stiffness" or "loss"."""
        weight = self._weight(kind)
        return _last(-self.Y[..., i] * self.x[:, :, j, None] * weight)

    def by_stretch_of(self, kind: str, row: Array) -> ComplexArray:
        """Derivative by a spring ("stiffness") or damper ("damping") on the first coordinates."""
        return self.by_stretch(row, self._weight(kind))

    def _weight(self, kind: str) -> ComplexArray:
        s = self.lines.s_rad_s
        one = np.ones_like(s)
        weight = {"mass": s**2, "damping": s, "stiffness": one, "loss": hysteresis(s)}[kind]
        return np.asarray(weight[:, None, None])

    def by_compliances(self, coordinates: Sequence[int]) -> ComplexArray:
        """Derivatives (k, m, 3, L) by the compliances of k coordinates."""
        left, right = self.through_compliances(coordinates)
        return np.asarray(left * right[:, :, None])

    def through_compliances(self, coordinates: Sequence[int]) -> tuple[ComplexArray, ComplexArray]:
        """What is recorded of a unit yield, and the torque that a unit hit puts there.

        Returns
        -------
        recorded : (k, m, 3, L), torque : (k, m, L), the compliance's own lag included
        """
        system, s = self.system, self.lines.s_rad_s
        n = self.inner.shape[-1]
        m = len(system.moved)
        w = self.inner[:, :, list(coordinates)]  # (L, n, k)

        def through(rows: Array) -> ComplexArray:
            return np.asarray(np.matmul(rows.reshape(m * 3, n), w).reshape(len(s), m, 3, -1))

        Uw = through(system.moved)
        s2 = (s**2)[:, None, None, None]
        o_w = s2 * through(system.seen) + through(system.tilted)
        o_HU = s2 * np.matmul(system.seen, self.HU.swapaxes(-1, -2)) + np.matmul(
            system.tilted, self.HU.swapaxes(-1, -2)
        )
        SUw = np.matmul(self.S, Uw)
        o_w = np.matmul(system.mix, o_w - np.matmul(o_HU, SUw))
        b = (system.force[:, None] @ system.hit)[:, 0][self.lines.hit]  # (m, n)
        b_HU = np.matmul(self.HU, b[..., None]).swapaxes(-1, -2)  # (L, m, 1, 3)
        w_b = np.matmul(b, w) - np.matmul(b_HU, SUw)[..., 0, :]  # (L, m, k)
        lag = 1.0 / (1.0 + system.compliance_loss_s[list(coordinates)] * s[:, None])
        torque = w_b * (self.factor[:, None] * lag)[:, None, :]
        return o_w.transpose(3, 1, 2, 0), torque.transpose(2, 1, 0)

    def by_link_inertia(self, link: int, changes: Array) -> ComplexArray:
        """Derivatives (k, m, 3, L) by k changes (k, 6, 6) of a link's spatial inertia.

        Gravity's stiffness is taken as it is: its part is far below the inertia's own.
        """
        pieces = self.system.pieces.get(link)
        if pieces is None:
            return self._by_inertia(self.system.link_motion[link], changes)
        split = np.stack([pieces.split(change) for change in changes], axis=1)
        parts = [self._by_inertia(J, own) for J, own in zip(pieces.motion, split, strict=True)]
        return np.asarray(np.sum(parts, axis=0))

    def _by_inertia(self, J: Array, changes: Array) -> ComplexArray:
        L, m, n = self.x.shape
        k = len(changes)
        V = self.x.reshape(-1, n) @ J.T  # (L m, 6)
        W = (self.Y.reshape(-1, n) @ J.T).reshape(L * m, 3, 6)
        bent = (V @ changes.transpose(2, 0, 1).reshape(6, k * 6)).reshape(L * m, k, 6)
        y = np.matmul(W, bent.swapaxes(1, 2)).reshape(L, m, 3, k)
        return np.asarray(-(y * (self.lines.s_rad_s**2)[:, None, None, None]).transpose(3, 1, 2, 0))

    def by_force(self, hit: int, change: Array) -> ComplexArray:
        """Derivative by the force's components (3,) of one hit."""
        b = change @ self.system.hit[hit]
        mine = (self.lines.hit == hit).astype(np.float64)
        return _last((self.Y @ b) * mine[:, None])

    def by_shift(self) -> ComplexArray:
        """Derivatives (3, m, 3, L) by a shift of each mounting along its own sensor's axes.

        The accelerometer's mass is taken to stay where it is.
        """
        turn = np.matmul(self.system.turned, self.x[..., None])[..., 0]  # (L, m, 3)
        scale = (self.factor * self.lines.s_rad_s**2)[:, None, None]
        moved = [np.cross(turn, axis) * scale for axis in np.eye(3)]
        return np.stack([_last(np.matmul(self.system.mix, a[..., None])[..., 0]) for a in moved])

    def by_slopes(self, slopes: Slopes) -> ComplexArray:
        """Derivatives (k, m, 3, L) by the k joint angles."""
        system, s = self.system, self.lines.s_rad_s
        L, m, n = self.x.shape
        k = len(slopes.mass)
        s2 = (s**2)[:, None, None]  # (L, 1, 1)
        x = self.x.swapaxes(0, 1)  # (m, L, n)

        def seen(by: Array) -> ComplexArray:
            """(m, L, k, 3) of motions (k, m, 3, n) at the mountings."""
            rows = by.transpose(1, 3, 0, 2).reshape(m, n, k * 3)
            return _times(x, rows).reshape(m, L, k, 3)

        pull = s2 * _times(x, slopes.mass.transpose(2, 0, 1).reshape(n, k * n)).reshape(m, L, k, n)
        if system.sensor_mass_kg:
            U, dU = system.moved, slopes.moved
            load = _times(seen(dU).reshape(m, L * k, 3), U).reshape(m, L, k, n)
            still = _times(x, U.swapaxes(1, 2))  # (m, L, 3)
            load = load + _times(still, dU.transpose(1, 2, 0, 3).reshape(m, 3, k * n)).reshape(
                m, L, k, n
            )
            pull += system.sensor_mass_kg * s2 * load
        push = np.einsum("ha,khan->khn", system.force, slopes.hit)[:, self.lines.hit]
        pull -= push.swapaxes(0, 1)[:, None]
        y = -np.matmul(pull, self.Y.transpose(1, 0, 3, 2))  # (m, L, k, 3)
        more = s2 * seen(system.mix @ slopes.seen) + seen(system.mix @ slopes.tilted)
        y += self.factor[:, None, None] * more
        return np.asarray(y.transpose(2, 0, 3, 1))

    def by_change(self, change: Change) -> ComplexArray:
        """Derivative by a parameter that changes the system as told."""
        system, s = self.system, self.lines.s_rad_s
        L, m, n = self.x.shape
        flat = self.x.reshape(-1, n)
        dZx = np.zeros((L, m, n), dtype=np.complex128)
        for matrix, power in (
            (change.mass, s**2),
            (change.damping, s),
            (change.stiffness, np.ones_like(s)),
            (change.loss, hysteresis(s)),
        ):
            if matrix is not None:
                dZx += power[:, None, None] * (flat @ matrix.T).reshape(L, m, n)
        column = self.x[..., None]
        if change.sensor_mass_kg is not None:
            load = np.matmul(system.moved.swapaxes(1, 2), np.matmul(system.moved, column))[..., 0]
            dZx += change.sensor_mass_kg * (s**2)[:, None, None] * load
        if change.moved is not None and system.sensor_mass_kg:
            U, dU = system.moved, change.moved
            both = np.matmul(dU.swapaxes(1, 2), np.matmul(U, column)) + np.matmul(
                U.swapaxes(1, 2), np.matmul(dU, column)
            )
            dZx += system.sensor_mass_kg * (s**2)[:, None, None] * both[..., 0]
        if change.hit is not None:
            dZx -= (system.force[:, None] @ change.hit)[:, 0][self.lines.hit]
        if change.force is not None:
            dZx -= (change.force[:, None] @ system.hit)[:, 0][self.lines.hit]
        y = -np.matmul(self.Y, dZx[..., None])[..., 0]
        more = np.zeros_like(y)
        if change.seen is not None:
            more += (s**2)[:, None, None] * np.matmul(change.seen, column)[..., 0]
        if change.tilted is not None:
            more += np.matmul(change.tilted, column)[..., 0]
        if change.seen is not None or change.tilted is not None:
            y = y + self.factor[:, None, None] * np.matmul(system.mix, more[..., None])[..., 0]
        if change.mix is not None:
            y = y + np.matmul(change.mix, self.true_axes[..., None])[..., 0]
        return _last(y)


def _times(z: ComplexArray, real: Array) -> ComplexArray:
    """Complex (..., k, n) by real (..., n, j) matrices."""
    found = np.empty(
        (*np.broadcast_shapes(z.shape[:-2], real.shape[:-2]), z.shape[-2], real.shape[-1]),
        dtype=np.complex128,
    )
    found.real, found.imag = np.matmul(z.real, real), np.matmul(z.imag, real)
    return found


def _last(y: ComplexArray) -> ComplexArray:
    """(L, m, 3) to (m, 3, L)."""
    return np.asarray(y.transpose(1, 2, 0))


def respond(system: System, lines: PostureLines) -> Response:
    """Solve a system on its lines, as far from them as a hidden window moved them."""
    if system.decay_rad_s:
        lines = replace(lines, s_rad_s=lines.s_rad_s + system.decay_rad_s)
    s = lines.s_rad_s
    n = system.mass.shape[0]
    m = len(lines.sensor_point)
    L = s.size
    soft = np.isfinite(system.compliance)
    gamma = np.where(soft, system.compliance, 1.0)
    scale = np.where(soft, gamma / (1.0 + s[:, None] * system.compliance_loss_s), 1.0)  # (L, n)
    Z = (
        (s**2)[:, None, None] * system.mass
        + s[:, None, None] * system.damping
        + system.stiffness
        + hysteresis(s)[:, None, None] * system.loss
    )
    A = scale[:, :, None] * Z
    A[:, soft, soft] += 1.0
    inner = np.linalg.inv(A)
    H = inner * scale[:, None, :]  # symmetric

    def rows(of: Array) -> ComplexArray:
        return np.asarray(np.matmul(of.reshape(m * 3, n), H).reshape(L, m, 3, n))

    U = system.moved  # (m, 3, n)
    HU = rows(U)
    ms2 = (system.sensor_mass_kg * s**2)[:, None, None, None]
    S = ms2 * np.linalg.inv(np.eye(3) + ms2 * np.matmul(HU, U.swapaxes(1, 2)))
    b = (system.force[:, None] @ system.hit)[:, 0]  # (n_hits, n)
    x0 = np.matmul(b, H)[:, lines.hit]  # (L, m, n)
    SUx = np.matmul(S, np.matmul(U, x0[..., None]))
    x = x0 - np.matmul(SUx.swapaxes(-1, -2), HU)[..., 0, :]
    # Loads along the recorded channels, so that their mixing is inside.
    Y0 = (s**2)[:, None, None, None] * rows(system.mix @ system.seen)
    Y0 = Y0 + rows(system.mix @ system.tilted)
    Y = Y0 - np.matmul(np.matmul(np.matmul(Y0, U.swapaxes(1, 2)), S), HU)
    factor = np.exp(system.log_scale - s * system.delay_s)
    raw = (s**2)[:, None, None] * np.matmul(system.seen, x[..., None])[..., 0]
    raw = raw + np.matmul(system.tilted, x[..., None])[..., 0]
    return Response(
        system=system,
        lines=lines,
        factor=factor,
        x=x,
        Y=Y * factor[:, None, None, None],
        true_axes=raw * factor[:, None, None],
        inner=inner,
        HU=HU,
        S=S,
    )
