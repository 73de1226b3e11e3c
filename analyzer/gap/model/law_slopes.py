"""How the torque of a joint's own law changes with every parameter of a model.

A parameter moves the turns of a joint under the torque as it is by dw. The torque changes with the
turn, and that the turn again:

    dx(t) = dw(t) - int g(t - u) dtau(u) du ,    dtau = (tangent of the law along x) dx ,

g the turn by a unit impulse of torque: one linear equation a hit, followed in steps that are long
beside those of the hit itself (`swings.py`), for all parameters at once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.joint_laws import Element
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.posed import Postures
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.gap.model.swings import SIGMA_RAD_S, STEP_S, pulse

__all__ = ["Tangents", "tangents_along", "torque_slopes"]

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_TOGETHER = (4, 2, 1)  # steps of a swing in one of its change: as many as are stable
_STABLE = 2.0  # of a step times the fastest frequency, squared; beyond 4 nothing is
_BAND_HZ = 200.0
_TAPER = 0.15  # of the band, cosine
_BLOCK = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Tangents:
    """An element along its swings, over long steps: `joint_laws.Tangent`, (..., n_steps, ...)."""

    at_once: int  # steps of a swing in a long one
    by_turn: Array32
    by_memory: Array32
    kept: Array32
    followed: Array32

    def of(self, rows: npt.NDArray[np.int64]) -> Tangents:
        """Return those of some swings, (P, m) of them."""
        return Tangents(
            at_once=self.at_once,
            by_turn=self.by_turn[rows],
            by_memory=self.by_memory[rows],
            kept=self.kept[rows],
            followed=self.followed[rows],
        )


def tangents_along(element: Element, turn: Array, by_torque: Sequence[ComplexArray]) -> Tangents:
    """Return an element's tangents along swings, over as long steps as are stable.

    Parameters
    ----------
    element, turn
        Of n rows; (n, n_steps) rad.
    by_torque
        (L,) turns by a unit torque, of every posture among them (`swings.Swings`).
    """
    n_lines = len(_lines(turn.shape[1], STEP_S))
    for at_once in _TOGETHER:
        found = _along(element, turn, at_once)
        steps = _Steps(at_once=at_once, n=turn.shape[1] // at_once)
        first = max(steps.step_s * steps.in_time(own[:n_lines], 0.0)[1] for own in by_torque)
        if first * found.by_turn.max() < _STABLE:
            break
    return found


def torque_slopes(
    together: Postures,
    plain: Hypothesis,
    space: Space,
    values: Mapping[str, float],
    rows: Array,
    by_torque: ComplexArray,
    tangents: Tangents,
    torque: Array,
) -> ComplexArray:
    """Return (n_parameters, P, m, L) what each parameter's deviation changes in the torque.

    Parameters
    ----------
    together
        The lines of P postures and levels.
    plain, space, values
        The model without the law, its parameters, and where it is.
    rows
        (P, N) by which the joint's spring stretches.
    by_torque
        (P, lines of `swings.Swings`) its turn by a unit torque, rad/(N m).
    tangents
        Of (P, m) swings, one a mounting.
    torque
        (P, m, n_steps) of the law under each mounting's hit, N m.

    Returns
    -------
    On the postures' lines, N m a N of each hit's force.
    """
    n_steps = torque.shape[-1]
    taken = torque * np.exp(-SIGMA_RAD_S * STEP_S * np.arange(n_steps))
    s = _lines(n_steps, STEP_S)
    on_lines = STEP_S * np.fft.rfft(taken)[..., : len(s)]
    forces = np.stack([_forces(own, s) for own in together.lines])
    every_s = np.broadcast_to(s, (len(rows), len(s)))
    by_force = together.turn_derivatives(
        plain, space, values, rows, every_s, on_lines / forces
    )  # (n_parameters, P, m, L)
    n_lines = len(together.lines[0].s_rad_s)
    found = np.zeros((*by_force.shape[:3], n_lines), dtype=np.complex64)
    moves = np.abs(by_force).max(axis=(1, 2, 3)) > 0.0
    steps = _Steps(at_once=tangents.at_once, n=n_steps // tangents.at_once)
    moved = steps.in_time(by_force[moves] * forces, steps.middle_s)
    by_impulse = steps.step_s * steps.in_time(by_torque[:, : len(s)], 0.0)
    change = _followed(tangents, moved, by_impulse)
    for p, own in enumerate(together.lines):
        kernel = np.exp(-np.outer(steps.seconds + steps.middle_s, own.s_rad_s))
        slopes = change[:, p] @ (steps.step_s * kernel).astype(np.complex64)
        found[moves, p] = slopes / _forces(own, own.s_rad_s)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class _Steps:
    """Steps in which changes are followed."""

    at_once: int  # steps of the swing
    n: int

    @property
    def step_s(self) -> float:
        """Return their length."""
        return self.at_once * STEP_S

    @property
    def middle_s(self) -> float:
        """Return when the middle of those of the swing is, from the first."""
        return 0.5 * (self.at_once - 1) * STEP_S

    @property
    def seconds(self) -> Array:
        """(n,) when each begins."""
        return np.asarray(self.step_s * np.arange(self.n))

    def in_time(self, on_lines: ComplexArray, later_s: float) -> Array32:
        """(..., n) of (..., L), so much later than each begins."""
        n = on_lines.shape[-1]
        taper = np.ones(n)
        ends = round(_TAPER * n)
        taper[-ends:] = 0.5 + 0.5 * np.cos(np.pi * (np.arange(ends) + 0.5) / ends)
        turned = np.exp(2j * np.pi * np.arange(n) / (self.n * self.step_s) * later_s)
        weight = (taper * turned / self.step_s).astype(np.complex64)
        window = np.exp(SIGMA_RAD_S * (self.seconds + later_s))
        return np.asarray(np.fft.irfft(on_lines * weight, self.n) * window, dtype=np.float32)


def _lines(n_steps: int, step_s: float) -> ComplexArray:
    f_hz = np.fft.rfftfreq(n_steps, step_s)
    return np.asarray(SIGMA_RAD_S + 2j * np.pi * f_hz[f_hz < _BAND_HZ])


def _forces(lines: PostureLines, s: ComplexArray) -> ComplexArray:
    """(m, L)."""
    return np.stack([pulse(s, float(peak), lines.width_s) for peak in lines.peaks_n])


def _along(element: Element, turn: Array, at_once: int) -> Tangents:
    """What the tangents of short steps make of a long one, the turn's change alike in each."""
    n, n_memory = len(turn), element.n_memory
    memory = np.zeros((n, n_memory))
    found = []
    for begin in range(0, turn.shape[1] - at_once + 1, at_once):
        kept, followed = np.ones((n, n_memory)), np.zeros((n, n_memory))
        by_turn, by_memory = np.zeros(n), np.zeros((n, n_memory))
        for x in turn[:, begin : begin + at_once].T:
            own = element.tangent(x, memory, STEP_S)
            by_turn += (own.by_turn + np.sum(own.by_memory * followed, axis=1)) / at_once
            by_memory += own.by_memory * kept / at_once
            followed = own.kept * followed + own.followed
            kept = own.kept * kept
            memory = element.remember(x, memory, STEP_S)
        found.append((by_turn, by_memory, kept, followed))
    every = [np.stack(own, axis=1).astype(np.float32) for own in zip(*found, strict=True)]
    return Tangents(
        at_once=at_once, by_turn=every[0], by_memory=every[1], kept=every[2], followed=every[3]
    )


def _followed(along: Tangents, moved: Array32, by_impulse: Array32) -> Array32:
    """Torque's changes (k, P, n, n_steps) under turns', alike; (P, n_steps) a step's torque."""
    n_steps = moved.shape[-1]
    change = np.zeros_like(moved)
    memory = np.zeros((*moved.shape[:3], along.kept.shape[-1]), dtype=np.float32)
    first = by_impulse[:, 0, None]
    left = 1.0 / (1.0 + first[..., None] * along.by_turn)
    for begin in range(0, n_steps, _BLOCK):
        block = np.arange(begin, min(begin + _BLOCK, n_steps))
        coming = moved[..., block]
        if begin:
            ago = block[None, :] - np.arange(begin)[:, None]
            coming = coming - change[..., :begin] @ by_impulse[:, ago]
        for i, at in enumerate(block):
            turn = coming[..., i]
            if i:
                back = by_impulse[:, i:0:-1, None]
                turn = turn - (change[..., begin:at] @ back)[..., 0]
            remembered = np.sum(along.by_memory[:, :, at] * memory, axis=-1)
            turn = (turn - first * remembered) * left[:, :, at]
            change[..., at] = along.by_turn[:, :, at] * turn + remembered
            memory = along.kept[:, :, at] * memory + along.followed[:, :, at] * turn[..., None]
    return change
