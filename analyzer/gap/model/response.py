"""FRFs of a system on its lines, and their derivatives; several postures at once.

With H(s) the receptance of the coordinates without the accelerometer, b the generalised force of a
unit hit, U the motion of the accelerometer's place and m its mass, the accelerometer changes the
motion to

    x = E H b,    E = I - H U S U',    S = m s^2 (I + m s^2 U' H U)^-1 ,

so that one inverse serves all mountings of a posture. o x with o = s^2 o_v + o_g is the recorded
acceleration, tilt of gravity included, and for any parameter

    d(o x) = do x - (o E H) dZ x + (o E H) db ,        Z = H^-1 + m s^2 U U' .

A loss factor eta is causal, leaves k as it is at a reference, and but for a drive's is constant:

    k (1 + eta L(s)),    L(s) = (2 / pi) ln(s / w_r),    L(i w) = i + (2 / pi) ln(w / w_r) .

A compliance gamma with losses changes H by w w' d(gamma / (1 + tau s + eta L(s))), w the motion per
unit torque inside that compliance: also at gamma = 0. Coordinates locked in all postures do not
move, and are left out; only what their compliances would change needs them.

Axes of arrays: P postures, m mountings, n coordinates that move, L lines, which are last wherever
single lines need no matrix: few long operations instead of many small ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.hysteresis import lost_by_power, relaxed
from armodal.analyzer.gap.model.dynamic_stiffness import dynamic_stiffness, inverses, resists
from armodal.analyzer.gap.model.geometry import skew
from armodal.analyzer.gap.model.line_arrays import (
    as_single,
    inverses_of_three,
    lines_last,
    of_hits,
    real_times,
    recorded,
)
from armodal.analyzer.gap.model.system import System

__all__ = ["Response", "respond"]

Array = npt.NDArray[np.floating[Any]]
Indices = npt.NDArray[np.int64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_SENSIBLE = 1e3  # m/N or rad/N: products of two such, with masses and s^2, are below 1e38
_AS_LOCKED = 1e-15  # rad/(N m) or m/N: less is divided by nowhere


@dataclass(frozen=True, kw_only=True)
class Response:
    """Solution of systems on their lines; what only derivatives need is solved when asked for."""

    system: System  # of P postures, with the coordinates that move
    whole: System  # with all N of them
    moving: Indices  # (n,) which those are
    s_rad_s: ComplexArray  # (P, L)
    hit: Indices  # (P, m) index into the system's hits
    factor: ComplexArray  # (P, L) of all channels: scale and delay
    x: ComplexArray  # (P, m, n, L) motion under the hit
    true_axes: ComplexArray  # (P, m, 3, L) before channels were mixed, factor included
    scale: ComplexArray  # (P, L, n) of the rows of A
    inner: ComplexArray  # (P, L, n, n) A^-1: column i is w of coordinate i
    H: ComplexArray  # (P, L, n, n) receptance without the accelerometer
    HU: ComplexArray  # (P, m, n, 3, L) columns H U'
    S: ComplexArray  # (P, m, 3, 3, L)
    added: ComplexArray | None = None  # (P, m, 3, L) what joints' own laws leave of linear ones

    @cached_property
    def under_loads(self) -> ComplexArray:
        """(P, m, n, 3, L) motion under unit loads on the recorded axes, factor included.

        Along the recorded channels, so that their mixing is inside.
        """
        system = self.system
        P, m, n, L = self.x.shape
        s2 = (self.s_rad_s**2)[:, :, None, None]
        seen, tilted = (
            (system.mix @ of).reshape(P, 1, m * 3, n) for of in (system.seen, system.tilted)
        )
        Y0 = lines_last(np.matmul(s2 * seen + tilted, self.H), m)
        Y0U = real_times(system.moved, Y0.reshape(P, m, n, 3 * L)).reshape(P, m, 3, 3, L)
        for c in range(3):
            load = sum(Y0U[:, :, b] * self.S[:, :, b, c, None] for b in range(3))  # (P, m, 3, L)
            Y0 -= self.HU[:, :, :, c, None] * np.asarray(load)[:, :, None]
        Y0 *= self.factor[:, None, None, None]
        return Y0

    @cached_property
    def for_derivatives(self) -> Response:
        """The same in single precision, enough at half the cost; itself where that is too narrow.

        A trial far from anything believable may lie near a pole, with an answer beyond all sense.
        """
        if not np.abs(self.x).max() < _SENSIBLE:
            return self
        kept = ("system", "whole", "moving", "hit", "added")
        names = [f.name for f in fields(self) if f.name not in kept]
        names += [] if self.added is None else ["added"]
        own: dict[str, Any] = {name: as_single(getattr(self, name)) for name in names}
        return replace(self, system=self.system.in_single(), **own)

    @cached_property
    def resists(self) -> ComplexArray:
        """(P, L, N) `dynamic_stiffness.resists` on these lines, of all coordinates."""
        found = resists(self.whole, self.s_rad_s.astype(complex))
        return np.asarray(found.astype(self.x.dtype, copy=False))

    @cached_property
    def places(self) -> Indices:
        """(N,) where each coordinate is among those that move; -1 of one that is locked."""
        found = np.full(self.whole.compliance.shape[1], -1)
        found[self.moving] = np.arange(len(self.moving))
        return found

    @property
    def values(self) -> ComplexArray:
        """(P, m, 3, L) accelerance as recorded."""
        linear = real_times(self.system.mix, self.true_axes)
        return linear if self.added is None else linear + self.added

    def under_a_torque(self, row: Array) -> ComplexArray:
        """(P, m, 3, L) what is recorded of a unit torque along a row (P, N)."""
        return self._along(row)[0]

    def by_stretch(self, row: Array, weight: ComplexArray | Array) -> ComplexArray:
        """Derivative by a spring (weight 1) or a damper (weight s) that stretches by row . x.

        `row` (P, N), `weight` (P, L).
        """
        load, stretch = self._along(row)
        weight = weight.astype(self.x.dtype, copy=False)
        return np.asarray(load * (stretch * -weight[:, None, :])[:, :, None])

    def by_stretches(self, one: Array, other: Array, weight: ComplexArray) -> ComplexArray:
        """Derivative by an element between two stretches (P, N), both ways."""
        (load, stretch), (load_other, stretch_other) = self._along(one), self._along(other)
        weight = weight[:, None, None, :]
        y = load * stretch_other[:, :, None] + load_other * stretch[:, :, None]
        return np.asarray(-weight * y)

    def _along(self, row: Array) -> tuple[ComplexArray, ComplexArray]:
        """(P, m, 3, L) under the loads and (P, m, L) under the hit, along a row (P, up to N)."""
        had = self.moving[self.moving < row.shape[1]]  # it ends with those there when it was added
        row = row[:, had].astype(self.x.real.dtype, copy=False)
        load, stretch = np.zeros_like(self.true_axes), np.zeros_like(self.x[:, :, 0])
        for i in np.flatnonzero(np.any(row, axis=0)):
            load += self.under_loads[:, :, i] * row[:, i, None, None, None]
            stretch += self.x[:, :, i] * row[:, i, None, None]
        return load, stretch

    def by_term(self, kind: str, i: int, j: int) -> ComplexArray:
        """Derivative by an element of "mass", "damping", "stiffness" or "loss", of N by N."""
        i, j = int(self.places[i]), int(self.places[j])
        if min(i, j) < 0:
            return np.zeros_like(self.true_axes)
        stretch = self.x[:, :, j] * -self.weight(kind)[:, None, :]
        return np.asarray(self.under_loads[:, :, i] * stretch[:, :, None])

    def by_stretch_of(self, kind: str, row: Array) -> ComplexArray:
        """Derivative by a spring ("stiffness") or damper ("damping"); row (P, N)."""
        return self.by_stretch(row, self.weight(kind))

    def weight(self, kind: str) -> ComplexArray:
        """Return (P, L) what "mass", "damping", "stiffness" or "loss" is multiplied by in Z."""
        s = self.s_rad_s
        if kind == "loss":
            return np.asarray(lost_by_power(s, self.system.loss_power).astype(s.dtype, copy=False))
        return {"mass": s**2, "damping": s, "stiffness": np.ones_like(s)}[kind]

    @cached_property
    def relaxed(self) -> ComplexArray:
        """(r, P, L) what each drive's part that relaxes is multiplied by in Z."""
        s = self.s_rad_s
        rates = self.system.relaxing_rad_s.T
        own = [relaxed(s, rate).astype(s.dtype, copy=False) for rate in rates]
        return np.reshape(own, (len(own), *s.shape))

    def by_compliances(self, coordinates: Sequence[int]) -> ComplexArray:
        """Derivatives (k, P, m, 3, L) by the compliances of k of the N coordinates.

        H has the compliance as a factor on both sides: where none is zero that is divided out.
        """
        gamma = self.whole.compliance[:, list(coordinates)].astype(self.x.real.dtype)
        found = np.empty((len(coordinates), *self._shape), dtype=self.x.dtype)
        locked = [i for i, column in enumerate(gamma.T) if (column < _AS_LOCKED).any()]
        if locked:
            left, right = self.through_compliances([coordinates[i] for i in locked])
            found[locked] = left * right[:, :, :, None]
        resist = self.resists
        for i, at in enumerate(coordinates):
            if i not in locked:
                own = self.places[at]
                yields = gamma[:, i, None]
                torque = self.x[:, :, own] * (resist[:, :, at] / yields)[:, None, :]
                torque *= (1.0 / yields)[:, None]  # the other side's
                np.multiply(self.under_loads[:, :, own], torque[:, :, None], out=found[i])
        return found

    @property
    def _shape(self) -> tuple[int, ...]:
        P, m, _, L = self.x.shape
        return P, m, 3, L

    def through_compliances(self, coordinates: Sequence[int]) -> tuple[ComplexArray, ComplexArray]:
        """What is recorded of a unit yield of k of the N coordinates, and the hit's torque there.

        Returns
        -------
        recorded : (k, P, m, 3, L), torque : (k, P, m, L) by a unit hit, the compliance's own lag
            included
        """
        system, s = self.system, self.s_rad_s
        P, m, n, L = self.x.shape
        k, real = len(coordinates), self.x.real.dtype
        w = np.ascontiguousarray(self._yields(coordinates).transpose(0, 2, 3, 1))
        w = w.reshape(P, 1, n, k * L)
        HU = self.HU.reshape(P, m, n, 3 * L)
        s2 = (s**2)[:, None, None, None]
        # A locked coordinate yields by itself, besides what moves with it.
        itself = [i for i, at in enumerate(coordinates) if self.places[at] < 0]
        locked = [coordinates[i] for i in itself]

        def through(rows: Array, whole: Array) -> ComplexArray:
            """(P, m, rows, k, L) motion by a unit yield, the accelerometer left out."""
            found = real_times(rows, w).reshape(P, m, -1, k, L)
            if itself:
                found[:, :, :, itself] += whole[..., locked].astype(real)[..., None]
            return found

        def loaded(rows: Array) -> ComplexArray:
            """(P, m, rows, 3, L) motion by a unit pull of the accelerometer."""
            return real_times(rows, HU).reshape(P, m, -1, 3, L)

        Uw = through(system.moved, self.whole.moved)
        SUw = [
            np.asarray(sum(self.S[:, :, a, b, None] * Uw[:, :, b] for b in range(3)))
            for a in range(3)
        ]

        def with_sensor(motion: ComplexArray, by_pull: ComplexArray) -> ComplexArray:
            for a in range(3):
                motion = motion - by_pull[:, :, :, a, None] * SUw[a][:, :, None]
            return motion

        o_w = with_sensor(
            s2 * through(system.seen, self.whole.seen) + through(system.tilted, self.whole.tilted),
            s2 * loaded(system.seen) + loaded(system.tilted),
        )
        recorded = real_times(system.mix, o_w.reshape(P, m, 3, k * L)).reshape(P, m, 3, k, L)
        b, whole = (
            of_hits(_hit_forces(of), self.hit)[:, :, None].astype(real, copy=False)
            for of in (system, self.whole)
        )  # (P, m, 1, n or N)
        w_b = with_sensor(through(b, whole), loaded(b))[:, :, 0]
        lag = 1.0 / self.resists[:, :, list(coordinates)].transpose(0, 2, 1)
        torque = w_b * (self.factor[:, None] * lag)[:, None]  # (P, m, k, L)
        return recorded.transpose(3, 0, 1, 2, 4), torque.transpose(2, 0, 1, 3)

    def _yields(self, coordinates: Sequence[int]) -> ComplexArray:
        """(P, L, n, k) motion of what moves by a unit yield of k of the N coordinates."""
        found = np.empty((*self.inner.shape[:3], len(coordinates)), dtype=self.inner.dtype)
        at = self.places[list(coordinates)]
        free, locked = at >= 0, at < 0
        found[..., free] = self.inner[..., at[free]]
        if locked.any():
            s = self.s_rad_s.astype(complex)
            columns = np.asarray(coordinates)[locked]
            load = -self.scale[..., None] * dynamic_stiffness(self.whole, s, self.moving, columns)
            found[..., locked] = self.inner @ load.astype(self.inner.dtype, copy=False)
        return found

    def by_link_inertia(self, link: int, changes: Array, *, at_root: bool = False) -> ComplexArray:
        """Derivatives (k, P, m, 3, L) by k changes (k, 6, 6) of a link's spatial inertia.

        Gravity's stiffness is taken as it is: its part is far below the inertia's own. `at_root`:
        of what moves with the link's root, whatever pieces the link is in.
        """
        pieces = None if at_root else self.system.pieces.get(link)
        if pieces is None:
            return self._by_inertia(self.system.link_motion[:, link], changes)
        split = pieces.split(changes).swapaxes(0, 1)  # (pieces, k, 6, 6)
        motions = pieces.motion.swapaxes(0, 1)  # (pieces, P, 6, n)
        parts = [self._by_inertia(J, own) for J, own in zip(motions, split, strict=True)]
        return np.asarray(np.sum(parts, axis=0))

    def by_base_inertia(self, changes: Array) -> ComplexArray:
        """Derivatives (k, P, m, 3, L) by k changes (k, 6, 6) of the base's spatial inertia."""
        return self._by_inertia(self.system.base_motion, changes)

    def _by_inertia(self, J: Array, changes: Array) -> ComplexArray:
        """`J` (P, 6, n), `changes` (k, 6, 6)."""
        P, m, n, L = self.x.shape
        J, changes = (of.astype(self.x.real.dtype, copy=False) for of in (J, changes))
        V = real_times(J[:, None], self.x)  # (P, m, 6, L)
        V *= -(self.s_rad_s**2)[:, None, None, :]
        W = real_times(J[:, None], self.under_loads.reshape(P, m, n, 3 * L))
        products = W.reshape(P, m, 6, 1, 3, L) * V[:, :, None, :, None]  # (P, m, 6, 6, 3, L)
        y = real_times(changes.reshape(-1, 36), products.reshape(P, m, 36, 3 * L))
        return np.asarray(y.reshape(P, m, -1, 3, L).transpose(2, 0, 1, 3, 4))

    def by_forces(self, change: Array) -> ComplexArray:
        """Derivative by the forces (P, n_hits, 3), of each mounting by its own hit's."""
        return self._by_loads(change[:, :, None] @ self.system.hit)

    def by_moments(self, change: Array) -> ComplexArray:
        """Likewise by moments (P, n_hits, 3) beside the forces."""
        return self._by_loads(change[:, :, None] @ self.system.hit_turned)

    def _by_loads(self, loads: Array) -> ComplexArray:
        """`loads` (P, n_hits, 1, n)."""
        P, m, n, L = self.x.shape
        own = of_hits(loads, self.hit).astype(self.x.real.dtype, copy=False)
        y = real_times(own, self.under_loads.reshape(P, m, n, 3 * L))
        return np.asarray(y.reshape(P, m, 3, L))

    def by_sensor_mass(self) -> ComplexArray:
        """Derivative by the mass of every accelerometer."""
        P, m, n, L = self.x.shape
        U = self.system.moved
        motion = real_times(U, self.x)  # (P, m, 3, L)
        motion *= -(self.s_rad_s**2)[:, None, None]
        under = real_times(U, self.under_loads.reshape(P, m, n, 3 * L)).reshape(P, m, 3, 3, L)
        return np.asarray(sum(under[:, :, b] * motion[:, :, b, None] for b in range(3)))

    def by_shift(self) -> ComplexArray:
        """Derivatives (3, P, m, 3, L) by a shift of each mounting along its own sensor's axes.

        The accelerometer's mass is taken to stay where it is.
        """
        turn = real_times(self.system.turned, self.x)  # (P, m, 3, L)
        turn = turn * (self.factor * self.s_rad_s**2)[:, None, None]
        mix = self.system.mix
        turns = (mix @ skew(axis).astype(mix.dtype) for axis in np.eye(3))
        return np.stack([-real_times(rows, turn) for rows in turns])


def _hit_forces(system: System) -> Array:
    """(P, n_hits, n) generalised forces."""
    return np.asarray((system.force[:, :, None] @ system.hit)[:, :, 0])


def respond(system: System, s_rad_s: ComplexArray, hit: npt.NDArray[np.int64]) -> Response:
    """Solve systems of P postures on their lines, as far from them as a hidden window moved them.

    `s_rad_s` (P, L), `hit` (P, m): each mounting's, index into the system's.
    """
    whole, moving = system, system.moving()
    system = whole.among(moving)
    s = s_rad_s + system.decay_rad_s[:, None]
    soft = np.isfinite(system.compliance[0])
    gamma = np.where(soft, system.compliance, 1.0)[:, None]
    scale = np.where(soft, gamma / resists(system, s), 1.0)  # (P, L, n)
    A = dynamic_stiffness(system, s)
    A *= scale[..., None]
    A[..., soft, soft] += 1.0
    inner = inverses(A)
    H = inner * scale[:, :, None, :]  # symmetric
    U = system.moved  # (P, m, 3, n)
    P, m, _, n = U.shape
    L = s.shape[1]
    HU = lines_last(real_times(U.reshape(P, 1, m * 3, n), H), m)
    ms2 = (system.sensor_mass_kg[:, None] * s**2)[:, None, None, None]
    UHU = real_times(U, HU.reshape(P, m, n, 3 * L)).reshape(P, m, 3, 3, L)
    S = ms2 * inverses_of_three(np.eye(3)[..., None] + ms2 * UHU)
    by_hit = np.matmul(_hit_forces(system)[:, None], H)  # (P, L, n_hits, n)
    x0 = of_hits(np.ascontiguousarray(by_hit.transpose(0, 2, 3, 1)), hit)  # (P, m, n, L)
    Ux = real_times(U, x0)  # (P, m, 3, L)
    x = x0.copy()
    for a in range(3):
        pull = sum(S[:, :, a, b] * Ux[:, :, b] for b in range(3))
        x -= HU[:, :, :, a] * np.asarray(pull)[:, :, None]
    factor = np.exp(system.log_scale[:, None] - s * system.delay_s[:, None])
    return Response(
        system=system,
        whole=whole,
        moving=moving,
        s_rad_s=s,
        hit=hit,
        factor=factor,
        x=x,
        true_axes=recorded(system.seen, system.tilted, s, x) * factor[:, None, None],
        scale=scale,
        inner=inner,
        H=H,
        HU=HU,
        S=S,
    )
