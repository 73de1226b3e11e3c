"""How the torque of a joint's own law changes with every parameter of a model.

A parameter moves the turns of a joint under the torque as it is by dw. The torque changes with the
turn, and that the turn again:

    dx(t) = dw(t) - int g(t - u) dtau(u) du ,    dtau = (tangent of the law along x) dx ,

g the turn by a unit impulse of torque: one linear equation a hit, followed as the hit itself is
(`march.py`), for many parameters at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.joint_laws import Element
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.posed import Postures
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.gap.model.steps import STEPS
from armodal.analyzer.gap.model.swings import lines_below, pulse, waves

__all__ = ["Tangents", "tangents_along", "torque_slopes"]

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_BAND_HZ = 200.0
_BLOCK = 20
_AT_ONCE = 2**24  # changes of turns, for memory's sake
_PARTS = STEPS.parts


@dataclass(frozen=True, slots=True, kw_only=True)
class Tangents:
    """What an element along swings makes of a change in each step (n, n_steps, ...).

    `parts` is the number of a step's parts, those of its turn first and those of its torque last.
    """

    by_turn: Array  # (parts, parts) N m/rad, of the torque
    by_memory: Array  # (parts, n_memory) of the torque
    kept: Array  # (n_memory,) of what is remembered, by itself a step before
    followed: Array  # (parts, n_memory) by the turn

    def of(self, rows: npt.NDArray[np.int64]) -> Tangents:
        """Return those of some swings, (P, m) of them."""
        return Tangents(
            by_turn=self.by_turn[rows],
            by_memory=self.by_memory[rows],
            kept=self.kept[rows],
            followed=self.followed[rows],
        )


def tangents_along(element: Element, turn: Array) -> Tangents:
    """Return an element's tangents along swings, of n rows and (n, parts n_steps) rad."""
    n, n_memory = len(turn), element.n_memory
    by_turn = np.zeros((STEPS.n, _PARTS, _PARTS, n))
    by_memory = np.zeros((STEPS.n, _PARTS, n, n_memory))
    kept = np.ones((STEPS.n, n, n_memory))
    followed = np.zeros((STEPS.n, _PARTS, n, n_memory))
    memory = np.zeros((n, n_memory))
    for at in range(STEPS.n):
        for part, lasts_s in enumerate(STEPS.lasts_s):
            x = turn[:, _PARTS * at + part]
            own = element.tangent(x, memory, lasts_s)
            by_turn[at, :, part] = np.einsum("ni,kni->kn", own.by_memory, followed[at])
            by_turn[at, part, part] = own.by_turn
            by_memory[at, part] = own.by_memory * kept[at]
            kept[at] *= own.kept
            followed[at] *= own.kept
            followed[at, part] = own.followed
            memory = element.remember(x, memory, lasts_s)
    return Tangents(
        by_turn=np.moveaxis(by_turn, 3, 0),
        by_memory=np.moveaxis(by_memory, 2, 0),
        kept=np.moveaxis(kept, 1, 0),
        followed=np.moveaxis(followed, 2, 0),
    )


def torque_slopes(
    together: Postures,
    plain: Hypothesis,
    space: Space,
    values: Mapping[str, float],
    rows: Array,
    by_steps: Array,
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
    by_steps
        (P, n_steps, parts, parts) rad/(N m), its turns by a torque (`Swings.by_steps`).
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
    solved = _solved(tangents, by_steps)
    answers = by_steps.astype(np.float32)
    in_time = _side_by_side(waves(len(s)).conj())
    at_once = max(1, _AT_ONCE // torque.size)
    for first in range(0, len(moves), at_once):
        some = moves[first : first + at_once]
        on_lines = np.moveaxis(by_force[some] * forces, 0, 3)  # (P, m, L, k)
        moved = in_time @ np.concatenate([on_lines.real, on_lines.imag], axis=2, dtype=np.float32)
        change = _followed(solved, moved, answers)
        for p, own in enumerate(together.lines):
            at = STEPS.weights_s * np.exp(-np.outer(own.s_rad_s, STEPS.seconds))
            taken = at.real.astype(np.float32) @ change[p] + 1j * (
                at.imag.astype(np.float32) @ change[p]
            )  # (m, L, k)
            found[some, p] = np.moveaxis(taken, 2, 0) / _forces(own, own.s_rad_s)
    return found


def _side_by_side(waves: ComplexArray) -> Array32:
    """Real and imaginary parts, (n, 2 L) of (n, L)."""
    return np.concatenate([waves.real, waves.imag], axis=1, dtype=np.float32)


def _forces(lines: PostureLines, s: ComplexArray) -> ComplexArray:
    """(m, L)."""
    return np.stack([pulse(s, float(peak), lines.width_s) for peak in lines.peaks_n])


@dataclass(frozen=True, slots=True, kw_only=True)
class _Solved:
    """What a step makes of a change, (n_steps, P, m, ...)."""

    turn: Array32  # (parts, parts) by the turn without the step's torque
    turn_by_memory: Array32  # (parts, n_memory)
    torque: Array32  # (parts, parts) by the turn
    torque_by_memory: Array32  # (parts, n_memory)
    kept: Array32  # (n_memory,)
    followed: Array32  # (n_memory, parts) by the turn


def _solved(along: Tangents, by_steps: Array) -> _Solved:
    """Of (P, m) swings."""
    taken = by_steps[:, None, None, 0]  # (P, 1, 1, parts, parts)
    by_turn = along.by_turn.swapaxes(-1, -2)  # torque's parts first
    turn = np.linalg.inv(np.eye(_PARTS) + taken @ by_turn)

    def steps_first(values: npt.NDArray[np.floating[Any]]) -> Array32:
        return np.ascontiguousarray(np.moveaxis(values, 2, 0), dtype=np.float32)

    return _Solved(
        turn=steps_first(turn),
        turn_by_memory=steps_first(-turn @ taken @ along.by_memory),
        torque=steps_first(by_turn),
        torque_by_memory=steps_first(along.by_memory),
        kept=steps_first(along.kept),
        followed=steps_first(along.followed.swapaxes(-1, -2)),
    )


def _followed(solved: _Solved, moved: Array32, by_steps: Array32) -> Array32:
    """Torque's changes under turns' (P, m, parts n_steps, k), alike."""
    n_postures, n_steps = by_steps.shape[:2]
    # (P, 1, parts, n_steps, parts of the torque)
    answers = np.ascontiguousarray(by_steps.transpose(0, 2, 1, 3))[:, None]
    change = np.empty_like(moved)
    memory = np.zeros((*moved.shape[:2], solved.kept.shape[-1], moved.shape[-1]), dtype=np.float32)
    for begin in range(0, n_steps, _BLOCK):
        end = min(begin + _BLOCK, n_steps)
        coming = moved[:, :, _PARTS * begin : _PARTS * end]
        if begin:
            ago = np.arange(begin, end)[:, None] - np.arange(begin)
            far = by_steps[:, ago].transpose(0, 1, 3, 2, 4)  # (P, block, parts, begin, parts)
            far = far.reshape(n_postures, 1, -1, _PARTS * begin)
            coming = coming - far @ change[:, :, : _PARTS * begin]
        for at in range(begin, end):
            here = slice(_PARTS * at, _PARTS * (at + 1))
            wanted = coming[:, :, _PARTS * (at - begin) : _PARTS * (at - begin + 1)]
            if at > begin:
                near = answers[:, :, :, at - begin : 0 : -1].reshape(n_postures, 1, _PARTS, -1)
                wanted = wanted - near @ change[:, :, _PARTS * begin : here.start]
            turn = solved.turn[at] @ wanted
            if memory.size:
                turn += solved.turn_by_memory[at] @ memory
            change[:, :, here] = solved.torque[at] @ turn
            if memory.size:
                change[:, :, here] += solved.torque_by_memory[at] @ memory
                memory = solved.kept[at][..., None] * memory + solved.followed[at] @ turn
    return change
