"""What a parameter's step changes in the equations of several postures, and in their FRFs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.hysteresis import lost_by_power_slope_of_line, relaxed_slope_of_line
from armodal.analyzer.gap.model.line_arrays import of_hits, real_times
from armodal.analyzer.gap.model.response import Response
from armodal.analyzer.gap.model.system import System

__all__ = ["Change", "by_change", "by_decay"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """Difference of two systems over a parameter's step; None where nothing changes."""

    mass: Array | None = None
    damping: Array | None = None
    stiffness: Array | None = None
    loss: Array | None = None
    relaxing: Array | None = None
    moved: Array | None = None
    seen: Array | None = None
    tilted: Array | None = None
    mix: Array | None = None
    hit: Array | None = None
    force: Array | None = None
    sensor_mass_kg: Array | None = None

    @classmethod
    def between(cls, before: System, after: System, step: float) -> Change:
        """Change a unit of the parameter makes."""
        found: dict[str, Any] = {}
        for name in cls.__slots__:
            old, new = getattr(before, name), getattr(after, name)
            if not np.array_equal(old, new):
                found[name] = (new - old) / step
        return cls(**found)


def by_change(found: Response, change: Change) -> ComplexArray:
    """Derivative (P, m, 3, L) by a parameter that changes the systems as told."""
    system, x = found.system, found.x
    real = x.real.dtype
    U = system.moved
    s2 = (found.s_rad_s**2)[:, None, None]
    mass_kg = system.sensor_mass_kg[:, None, None, None]
    loads: list[tuple[Array, ComplexArray]] = [
        (matrix[:, None], found.weight(kind)[:, None, None])
        for matrix, kind in (
            (change.mass, "mass"),
            (change.damping, "damping"),
            (change.stiffness, "stiffness"),
            (change.loss, "loss"),
        )
        if matrix is not None
    ]
    if change.relaxing is not None:
        for r, weight in enumerate(found.relaxed):
            loads.append((change.relaxing[:, r, None], weight[:, None, None]))
    if change.sensor_mass_kg is not None:
        more = change.sensor_mass_kg[:, None, None, None]
        loads.append((more * (U.swapaxes(-1, -2) @ U), s2))
    if change.moved is not None and system.sensor_mass_kg.any():
        both = change.moved.swapaxes(-1, -2) @ U
        loads.append((mass_kg * (both + both.swapaxes(-1, -2)), s2))
    y = np.zeros_like(found.true_axes)
    if loads:
        dZx = sum(weight * real_times(of.astype(real), x) for of, weight in loads)
        y -= _under(found, np.asarray(dZx))
    for force, hit in ((system.force, change.hit), (change.force, system.hit)):
        if force is not None and hit is not None:
            push = np.einsum("pha,phan->phn", force, hit).astype(real)
            y += _pushed(found, of_hits(push, found.hit))
    seen = np.zeros_like(y)
    if change.seen is not None:
        seen += s2 * real_times(change.seen.astype(real), x)
    if change.tilted is not None:
        seen += real_times(change.tilted.astype(real), x)
    y += found.factor[:, None, None] * real_times(system.mix, seen)
    if change.mix is not None:
        y += real_times(change.mix.astype(real), found.true_axes)
    return y


def by_decay(found: Response) -> ComplexArray:
    """Derivative (P, m, 3, L) by a decay of all records: by the line s itself."""
    system, x, s = found.system, found.x, found.s_rad_s
    by_line = s[:, None, None]
    moved = real_times(system.mix @ system.seen, 2.0 * by_line * x)
    y = found.factor[:, None, None] * moved
    y -= system.delay_s[:, None, None, None] * found.values
    dZx = 2.0 * by_line * real_times(system.mass[:, None], x)
    dZx += real_times(system.damping[:, None], x)
    lost = lost_by_power_slope_of_line(s, system.loss_power).astype(s.dtype)
    dZx += lost[:, None, None] * real_times(system.loss[:, None], x)
    for r, rate in enumerate(system.relaxing_rad_s.T):
        if system.relaxing[:, r].any():
            lost = relaxed_slope_of_line(s, rate).astype(s.dtype)
            dZx += lost[:, None, None] * real_times(system.relaxing[:, r, None], x)
    moved = real_times(system.moved, x)
    moved *= 2.0 * system.sensor_mass_kg[:, None, None, None] * by_line
    dZx += real_times(system.moved.swapaxes(-1, -2), moved)
    # A compliance resists by (1 + tau s + eta L(s)) / gamma; where it is zero nothing moves.
    gamma = system.compliance
    gives_way = np.isfinite(gamma) & (gamma != 0.0)
    per_gamma = np.where(gives_way, 1.0 / np.where(gives_way, gamma, 1.0), 0.0)[:, None, :, None]
    dZx += (per_gamma * system.compliance_loss_s[:, None, :, None]).astype(x.real.dtype) * x
    factor = per_gamma * system.compliance_loss_factor[:, None, :, None]
    dZx += factor.astype(x.real.dtype) * (2.0 / np.pi) / by_line * x
    return np.asarray(y - _under(found, dZx))


def _under(found: Response, pull: ComplexArray) -> ComplexArray:
    """(P, m, 3, L) recorded of loads (P, m, n, L) on the coordinates."""
    at = np.flatnonzero(pull.any(axis=(0, 1, 3)))
    y = np.zeros_like(found.true_axes)
    for i in at:
        y += found.under_loads[:, :, i] * pull[:, :, i, None]
    return y


def _pushed(found: Response, push: Array) -> ComplexArray:
    """(P, m, 3, L) recorded of loads (P, m, n) that are the same on all lines."""
    P, m, n, L = found.x.shape
    y = real_times(push[:, :, None], found.under_loads.reshape(P, m, n, 3 * L))
    return np.asarray(y.reshape(P, m, 3, L))
