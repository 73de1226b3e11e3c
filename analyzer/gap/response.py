"""FRFs of a system on its lines, and their derivatives.

With H(s) the receptance of the coordinates without the accelerometer, b the generalised force of a
unit hit, U the motion of the accelerometer's place and m its mass, the accelerometer changes the
motion to

    x = E H b,    E = I - H U S U',    S = m s^2 (I + m s^2 U' H U)^-1 ,

so that one inverse serves all mountings of a posture. o x with o = s^2 o_v + o_g is the recorded
acceleration, tilt of gravity included, and for any parameter

    d(o x) = do x - (o E H) dZ x + (o E H) db ,        Z = H^-1 + m s^2 U U' .

A compliance gamma with loss tau changes H by w w' d(gamma / (1 + tau s)), w the motion per unit
torque inside that compliance: also at gamma = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from analyzer.gap.assembly import System
from analyzer.gap.lines import PostureLines

__all__ = ["Change", "Response", "respond"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


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

    @classmethod
    def between(cls, before: System, after: System, step: float) -> Change:
        """Change a unit of the parameter makes."""
        found: dict[str, Array] = {}
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
    sensor_mass_kg: float
    factor: ComplexArray  # (L,) of all channels: scale and delay
    x: ComplexArray  # (L, m, n) motion under the hit
    Y: ComplexArray  # (L, n, m, 3) motion under unit loads on the recorded axes, factor included
    true_axes: ComplexArray  # (L, m, 3) before channels were mixed, factor included
    inner: ComplexArray  # (L, n, n) A^-1: column i is w of coordinate i
    HU: ComplexArray  # (L, n, m, 3)
    o_HU: ComplexArray  # (L, m, 3, 3) true-axis acceleration of the motions H U
    S: ComplexArray  # (L, m, 3, 3)

    @property
    def values(self) -> ComplexArray:
        """(m, 3, L) accelerance as recorded."""
        y = np.einsum("mij,lmj->mil", self.system.mix, self.true_axes)
        return np.asarray(y)

    def by_stretch(self, row: Array, weight: ComplexArray | float) -> ComplexArray:
        """Derivative by a spring (weight 1) or a damper (weight s) that stretches by row . x."""
        at = np.flatnonzero(row)
        Y = np.einsum("k,lkmi->lmi", row[at], self.Y[:, at])
        x = self.x[:, :, at] @ row[at]
        product = -Y * x[:, :, None] * np.reshape(weight, (-1, 1, 1))
        return np.asarray(np.moveaxis(product, 0, 2))

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
        L, n, _ = self.inner.shape
        m, k = len(system.moved), len(coordinates)
        w = self.inner[:, :, list(coordinates)]  # (L, n, k)

        def through(rows: Array) -> ComplexArray:
            flat = rows.reshape(m * 3, n) @ w.transpose(1, 0, 2).reshape(n, L * k)
            return np.asarray(flat.reshape(m, 3, L, k))

        Uw = through(system.moved)
        o_w = (s**2)[:, None] * through(system.seen) + through(system.tilted)
        SUw = np.einsum("lmij,mjlk->lmik", self.S, Uw, optimize=True)
        o_w = o_w - np.einsum("lmij,lmjk->milk", self.o_HU, SUw, optimize=True)
        b = np.einsum("hjn,hj->hn", system.hit, system.force)[self.lines.hit]
        w_b = np.einsum("lnk,mn->lmk", w, b, optimize=True)
        x0_U = np.einsum("lnmj,mn->lmj", self.HU, b, optimize=True)
        w_b = w_b - np.einsum("lmj,lmjk->lmk", x0_U, SUw, optimize=True)
        lag = 1.0 / (1.0 + system.compliance_loss_s[list(coordinates)] * s[:, None])  # (L, k)
        torque = w_b * (self.factor[:, None] * lag)[:, None, :]
        recorded = np.einsum("mij,mjlk->milk", system.mix, o_w)
        return recorded.transpose(3, 0, 1, 2), torque.transpose(2, 1, 0)

    def by_link_inertia(self, link: int, changes: Array) -> ComplexArray:
        """Derivatives (k, m, 3, L) by k changes (k, 6, 6) of a link's spatial inertia.

        Gravity's stiffness is taken as it is: its part is far below the inertia's own.
        """
        J = self.system.link_motion[link]
        L, m, n = self.x.shape
        V = self.x.reshape(-1, n) @ J.T  # (L m, 6)
        W = np.einsum("an,lnmi->lmia", J, self.Y, optimize=True).reshape(L * m, 3, 6)
        bent = np.einsum("kab,zb->kza", changes, V, optimize=True)
        y = np.matmul(W[None], bent[..., None])[..., 0].reshape(len(changes), L, m, 3)
        return np.asarray(-np.moveaxis(y * (self.lines.s_rad_s**2)[:, None, None], 1, 3))

    def by_force(self, hit: int, change: Array) -> ComplexArray:
        """Derivative by the force's components (3,) of one hit."""
        b = change @ self.system.hit[hit]
        mine = (self.lines.hit == hit).astype(np.float64)
        return np.asarray(np.einsum("lnmi,n,m->mil", self.Y, b, mine, optimize=True))

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
            (change.loss, np.full_like(s, 1j)),
        ):
            if matrix is not None:
                dZx += power[:, None, None] * (flat @ matrix.T).reshape(L, m, n)
        if change.moved is not None and self.sensor_mass_kg:
            U, dU = system.moved, change.moved
            Ux = np.einsum("mjn,lmn->lmj", U, self.x)
            dUx = np.einsum("mjn,lmn->lmj", dU, self.x)
            both = np.einsum("mjn,lmj->lmn", dU, Ux) + np.einsum("mjn,lmj->lmn", U, dUx)
            dZx += self.sensor_mass_kg * (s**2)[:, None, None] * both
        if change.hit is not None:
            b = np.einsum("hjn,hj->hn", change.hit, system.force)
            dZx -= b[self.lines.hit]
        if change.force is not None:
            b = np.einsum("hjn,hj->hn", system.hit, change.force)
            dZx -= b[self.lines.hit]
        y = -np.einsum("lnmi,lmn->lmi", self.Y, dZx, optimize=True)
        if change.seen is not None or change.tilted is not None:
            seen = (
                0.0
                if change.seen is None
                else (s**2)[:, None, None] * np.einsum("min,lmn->lmi", change.seen, self.x)
            )
            tilted = (
                0.0 if change.tilted is None else np.einsum("min,lmn->lmi", change.tilted, self.x)
            )
            more = np.einsum("mij,lmj->lmi", system.mix, seen + tilted)
            y = y + self.factor[:, None, None] * more
        if change.mix is not None:
            y = y + np.einsum("mij,lmj->lmi", change.mix, self.true_axes)
        return np.asarray(np.moveaxis(y, 0, 2))


def respond(system: System, lines: PostureLines, *, sensor_mass_kg: float) -> Response:
    """Solve a system on its lines."""
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
        + (system.stiffness + 1j * system.loss)
    )
    A = scale[:, :, None] * Z
    A[:, soft, soft] += 1.0
    inner = np.linalg.inv(A)
    H = inner * scale[:, None, :]
    U = system.moved  # (m, 3, n)
    HU = (H.reshape(L * n, n) @ U.reshape(m * 3, n).T).reshape(L, n, m, 3)
    ms2 = sensor_mass_kg * s**2
    UHU = np.einsum("mjn,lnmk->lmjk", U, HU, optimize=True)
    o_HU = (s**2)[:, None, None, None] * np.einsum(
        "min,lnmk->lmik", system.seen, HU, optimize=True
    ) + np.einsum("min,lnmk->lmik", system.tilted, HU, optimize=True)
    S = ms2[:, None, None, None] * np.linalg.inv(np.eye(3) + ms2[:, None, None, None] * UHU)
    b = np.einsum("hjn,hj->hn", system.hit, system.force)
    x0 = (H @ b.T).transpose(0, 2, 1)[:, lines.hit]  # (L, m, n)
    SUx = np.einsum("lmjk,lmk->lmj", S, np.einsum("mkn,lmn->lmk", U, x0), optimize=True)
    x = x0 - np.einsum("lnmj,lmj->lmn", HU, SUx, optimize=True)
    # Loads along the recorded channels, so that their mixing is inside.
    seen = np.einsum("mij,mjn->min", system.mix, system.seen)
    tilted = np.einsum("mij,mjn->min", system.mix, system.tilted)
    flat = H.reshape(L * n, n)
    Y0 = (s**2)[:, None, None, None] * (flat @ seen.reshape(m * 3, n).T).reshape(L, n, m, 3)
    Y0 = Y0 + (flat @ tilted.reshape(m * 3, n).T).reshape(L, n, m, 3)
    UY = np.einsum("mjn,lnmi->lmji", U, Y0, optimize=True)
    Y = Y0 - np.einsum("lnmj,lmjk,lmki->lnmi", HU, S, UY, optimize=True)
    factor = np.exp(system.log_scale - s * system.delay_s)
    raw = (s**2)[:, None, None] * np.einsum("min,lmn->lmi", system.seen, x)
    raw = raw + np.einsum("min,lmn->lmi", system.tilted, x)
    return Response(
        system=system,
        lines=lines,
        sensor_mass_kg=sensor_mass_kg,
        factor=factor,
        x=x,
        Y=Y * factor[:, None, None, None],
        true_axes=raw * factor[:, None, None],
        inner=inner,
        HU=HU,
        o_HU=o_HU,
        S=S,
    )
