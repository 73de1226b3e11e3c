"""How the torque of a joint's own law changes with every parameter of a model.

A parameter moves the turns of a joint under the torque as it is by dw. The torque changes with the
turn, and that the turn again:

    dx(t) = dw(t) - int g(t - u) dtau(u) du ,    dtau = (tangent of the law along x) dx ,

g the turn by a unit impulse of torque: one linear equation a hit, followed as the hit itself is
(`march.py`) but in longer steps, for many parameters at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.joint_laws import Element
from armodal.analyzer.gap.model.line_arrays import real_times
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.posed import Postures
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.gap.model.steps import LONG, STEPS
from armodal.analyzer.gap.model.swings import in_steps, lines_below, pulse

__all__ = ["Tangents", "tangents_along", "torque_slopes"]

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_BAND_HZ = 200.0
_BLOCK = 20
_AT_ONCE = 2**24  # changes of turns, for memory's sake
_PARTS = LONG.parts
# Where parts of long steps end among those of the others, next to.
_ENDS = np.array([np.argmin(np.abs(STEPS.seconds - end)) for end in LONG.seconds])


@dataclass(frozen=True, slots=True)
class Tangents:
    """An element along swings: `joint_laws.Tangent` over each part of a long step.

    (..., n_steps, parts, ...).
    """

    by_turn: Array32
    by_memory: Array32
    kept: Array32
    followed: Array32

    def of(self, rows: npt.NDArray[np.int64]) -> Tangents:
        """Return those of some swings, (P, m) of them."""
        every = (self.by_turn, self.by_memory, self.kept, self.followed)
        return Tangents(*(own[rows] for own in every))


def tangents_along(element: Element, turn: Array) -> Tangents:
    """Return an element's tangents along swings, its turn's change alike all over a part.

    Of n rows, and (n, parts n) rad in short steps.
    """
    n, n_memory = len(turn), element.n_memory
    memory = np.zeros((n, n_memory))
    lasts_s = np.tile(STEPS.lasts_s, STEPS.n)
    found, begin = [], 0
    for end in _ENDS + 1:
        kept, followed = np.ones((n, n_memory)), np.zeros((n, n_memory))
        by_turn, by_memory = np.zeros(n), np.zeros((n, n_memory))
        for i in range(begin, end):
            own = element.tangent(turn[:, i], memory, lasts_s[i])
            share = lasts_s[i] / lasts_s[begin:end].sum()
            by_turn += share * (own.by_turn + np.sum(own.by_memory * followed, axis=1))
            by_memory += share * own.by_memory * kept
            followed = own.kept * followed + own.followed
            kept = own.kept * kept
            memory = element.remember(turn[:, i], memory, lasts_s[i])
        found.append((by_turn, by_memory, kept, followed))
        begin = end
    every = [np.stack(own, axis=1).astype(np.float32) for own in zip(*found, strict=True)]
    return Tangents(*(own.reshape(n, LONG.n, _PARTS, *own.shape[2:]) for own in every))


def torque_slopes(
    together: Postures,
    plain: Hypothesis,
    space: Space,
    values: Mapping[str, float],
    rows: Array,
    by_long_steps: Array,
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
    by_long_steps
        (P, n_steps, parts, parts) rad/(N m), its turns by a torque (`Swings.by_long_steps`).
    tangents
        Of (P, m) swings, one a mounting.
    torque
        (P, m, parts n) of the law under each mounting's hit, N m.

    Returns
    -------
    On the postures' lines, N m a N of each hit's force.
    """
    s = lines_below(_BAND_HZ)
    on_lines = torque @ (STEPS.weights_s[:, None] * np.exp(-np.outer(STEPS.seconds, s)))
    forces = np.stack([_forces(own, s) for own in together.lines])
    every_s = np.broadcast_to(s, (len(rows), len(s)))
    by_force = together.turn_derivatives(
        plain, space, values, rows, every_s, on_lines / forces
    )  # (n_parameters, P, m, L)
    n_lines = len(together.lines[0].s_rad_s)
    found = np.zeros((*by_force.shape[:3], n_lines), dtype=np.complex64)
    moves = np.flatnonzero(np.abs(by_force).max(axis=(1, 2, 3)) > 0.0)
    in_time = by_long_steps.astype(np.float32)
    at_once = max(1, _AT_ONCE // torque.size)
    for first in range(0, len(moves), at_once):
        some = moves[first : first + at_once]
        moved = in_steps(by_force[some] * forces, LONG).astype(np.float32)
        change = _followed(tangents, moved, in_time)
        for p, own in enumerate(together.lines):
            at = LONG.weights_s[:, None] * np.exp(-np.outer(LONG.seconds, own.s_rad_s))
            taken = real_times(change[:, p], at.astype(np.complex64))
            found[some, p] = taken / _forces(own, own.s_rad_s)
    return found


def _forces(lines: PostureLines, s: ComplexArray) -> ComplexArray:
    """(m, L)."""
    return np.stack([pulse(s, float(peak), lines.width_s) for peak in lines.peaks_n])


def _followed(along: Tangents, moved: Array32, by_long_steps: Array32) -> Array32:
    """Torque's changes under turns' (k, P, m, parts n_steps), alike."""
    n_postures, n_steps = by_long_steps.shape[:2]
    # (P, n_steps, parts of the torque, parts)
    answers = np.ascontiguousarray(by_long_steps.transpose(0, 1, 3, 2))
    change = np.empty_like(moved)
    memory = np.zeros((*moved.shape[:3], along.kept.shape[-1]), dtype=np.float32)
    for begin in range(0, n_steps, _BLOCK):
        end = min(begin + _BLOCK, n_steps)
        coming = moved[..., _PARTS * begin : _PARTS * end]
        if begin:
            ago = np.arange(begin, end) - np.arange(begin)[:, None]
            far = answers[:, ago].swapaxes(2, 3).reshape(n_postures, _PARTS * begin, -1)
            coming = coming - change[..., : _PARTS * begin] @ far
        for at in range(begin, end):
            here = slice(_PARTS * at, _PARTS * (at + 1))
            wanted = coming[..., _PARTS * (at - begin) : _PARTS * (at - begin + 1)]
            if at > begin:
                near = answers[:, at - begin : 0 : -1].reshape(n_postures, -1, _PARTS)
                wanted = wanted - change[..., _PARTS * begin : here.start] @ near
            change[..., here], memory = _step(along, at, wanted, by_long_steps[:, 0], memory)
    return change


def _step(
    along: Tangents, at: int, wanted: Array32, taken: Array32, memory: Array32
) -> tuple[Array32, Array32]:
    """Torque's changes (k, P, m, 2) of both parts of a step, and what is remembered after it."""
    (by_0, by_1), (by_memory_0, by_memory_1), (kept_0, kept_1), (followed_0, followed_1) = (
        np.moveaxis(own[:, :, at], 2, 0)
        for own in (along.by_turn, along.by_memory, along.kept, along.followed)
    )
    # Torques by the turns of both parts, and by what is remembered before.
    across = _over(by_memory_1, followed_0)
    torque_0 = _over(by_memory_0, memory)
    torque_1 = _over(by_memory_1 * kept_0, memory)
    (w_00, w_01), (w_10, w_11) = np.moveaxis(taken, 0, 2)[..., None]
    off_0 = wanted[..., 0] - w_00 * torque_0 - w_01 * torque_1
    off_1 = wanted[..., 1] - w_10 * torque_0 - w_11 * torque_1
    a, b = 1.0 + w_00 * by_0 + w_01 * across, w_01 * by_1
    c, d = w_10 * by_0 + w_11 * across, 1.0 + w_11 * by_1
    left = 1.0 / (a * d - b * c)
    turn_0 = (left * d) * off_0 - (left * b) * off_1
    turn_1 = (left * a) * off_1 - (left * c) * off_0
    torque = np.empty_like(wanted)
    torque[..., 0] = torque_0 + by_0 * turn_0
    torque[..., 1] = torque_1 + across * turn_0 + by_1 * turn_1
    if memory.size:
        memory = kept_1 * kept_0 * memory + kept_1 * followed_0 * turn_0[..., None]
        memory += followed_1 * turn_1[..., None]
    return torque, memory


def _over(by_memory: Array32, memory: Array32) -> Array32:
    """Sum over what is remembered, the last axis of both."""
    return np.asarray(np.einsum("...i,...i->...", by_memory, memory))
