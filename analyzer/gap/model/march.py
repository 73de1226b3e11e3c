"""A joint followed step by step while a torque of its own law acts on it.

With x_0 the turn that a linear model foretells and g the turn by a unit impulse of torque,

    x(t) = x_0(t) - int g(t - u) tau(x(u), ...) du ,

one equation however many coordinates the arm has. The three parts of a step depend on each other
and are solved together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.joint_laws import Element, Tangent, rows_of
from armodal.analyzer.gap.model.steps import STEPS

__all__ = ["march"]

Array = npt.NDArray[np.float64]

_BLOCK = 12
_ROUNDING = 1e-9  # of the largest turn: a step of the solution that changes nothing
_MOST_TURNS, _HALVED = 50, 8  # of Newton's steps, and how often one is halved
_PARTS = STEPS.parts
_NEXT, _LAST = [1, 2, 0], [2, 0, 1]  # of three


def march(
    by_steps: Array, groups: npt.NDArray[np.int64], free: Array, element: Element
) -> tuple[Array, Array]:
    """Turns and torques (n, parts n_steps) of n swings with an element.

    Parameters
    ----------
    by_steps
        (P, n_steps, parts, parts) of every posture (`Swings.by_steps`).
    groups
        (n,) posture of each swing, ascending.
    free
        (n, parts n_steps) turns without it.
    element
        Of n rows.
    """
    n, n_steps = len(free), by_steps.shape[1]
    turn, torque = np.empty_like(free), np.empty_like(free)
    ahead, memory = np.zeros((_PARTS, n)), np.zeros((n, element.n_memory))
    # What torques of the steps before do to a step, the last at the end: (n, parts _BLOCK, parts).
    near = by_steps[groups, _BLOCK - 1 : 0 : -1].swapaxes(2, 3).reshape(n, -1, _PARTS)
    taken = np.ascontiguousarray(np.moveaxis(by_steps[groups, 0], 0, 2))  # (parts, parts, n)
    begins = np.searchsorted(groups, np.arange(len(by_steps) + 1))
    for begin in range(0, n_steps, _BLOCK):
        end = min(begin + _BLOCK, n_steps)
        coming = free[:, _PARTS * begin : _PARTS * end].copy()
        if begin:
            ago = np.arange(begin, end) - np.arange(begin)[:, None]
            for own, of_steps in zip(map(slice, begins, begins[1:]), by_steps, strict=True):
                far = of_steps[ago].transpose(0, 3, 1, 2).reshape(_PARTS * begin, -1)
                coming[own] -= torque[own, : _PARTS * begin] @ far
        for at in range(begin, end):
            here = slice(_PARTS * at, _PARTS * (at + 1))
            wanted = coming[:, _PARTS * (at - begin) : _PARTS * (at - begin + 1)]
            if at > begin:
                before = torque[:, _PARTS * begin : here.start]
                wanted = wanted - np.einsum("nk,nki->ni", before, near[:, -before.shape[1] :])
            there, its_torque, memory = _step(
                ahead, np.ascontiguousarray(wanted.T), taken, element, memory
            )
            turn[:, here], torque[:, here] = there.T, its_torque.T
            # As fast as in the part before.
            rate = (there[-1] - there[-2]) / STEPS.lasts_s[-1]
            ahead = there[-1] + np.cumsum(STEPS.lasts_s)[:, None] * rate
    return turn, torque


def _step(
    ahead: Array, wanted: Array, taken: Array, element: Element, memory: Array
) -> tuple[Array, Array, Array]:
    """Turns and torques (parts, n) of all parts of a step, and what is remembered after it.

    Newton's steps from `ahead`; where one would go past the corner of a slider and further
    from the solution it is halved. What has found its place is left there.
    """
    turn = ahead
    own = _at(turn, wanted, taken, element, memory)
    torque, after = own.torque, own.memories[-1]
    small = _ROUNDING * max(np.abs(turn).max(), np.abs(wanted).max())
    every = np.arange(turn.shape[1])
    for _ in range(_MOST_TURNS):
        # False of what is no number: that is told by who asked.
        goes_on = np.flatnonzero(np.abs(own.off).max(axis=0) > small)
        if goes_on.size == 0:
            break
        if goes_on.size < len(every):
            own, every = own.rows(goes_on), every[goes_on]
        own = own.further(small)
        turn[:, every], torque[:, every], after[every] = own.turn, own.torque, own.memories[-1]
    return turn, torque, after


@dataclass(frozen=True, slots=True, kw_only=True)
class _Active:
    """Swings in a step, where they are on the way to its solution."""

    turn: Array  # (parts, n)
    wanted: Array  # (parts, n)
    taken: Array  # (parts, parts, n)
    element: Element
    memory: Array
    torque: Array
    memories: Sequence[Array]  # after each part
    off: Array  # (parts, n) how far turns are off what their torques leave

    def rows(self, rows: npt.NDArray[np.int64]) -> _Active:
        """Return some of them."""
        return _Active(
            turn=self.turn[:, rows],
            wanted=self.wanted[:, rows],
            taken=self.taken[..., rows],
            element=rows_of(self.element, rows),
            memory=self.memory[rows],
            torque=self.torque[:, rows],
            off=self.off[:, rows],
            memories=[memory[rows] for memory in self.memories],
        )

    def further(self, small: float) -> _Active:
        """Return them a step of Newton's on; what is so small is nothing."""
        step = self._step()
        far = np.sum(self.off**2, axis=0)
        is_off = far > small**2
        part = np.ones(len(far))
        for _ in range(_HALVED):
            there = _at(self.turn - part * step, self.wanted, self.taken, self.element, self.memory)
            worse = (np.sum(there.off**2, axis=0) >= far) & is_off
            if not worse.any():
                break
            part[worse] *= 0.5
        return there

    def _step(self) -> Array:
        """By Cramer's rule."""
        slope = np.zeros_like(self.taken)
        before: list[Tangent] = []
        memory = self.memory
        for part, lasts_s in enumerate(STEPS.lasts_s):
            own = self.element.tangent(self.turn[part], memory, lasts_s)
            slope[part, part] = own.by_turn
            if memory.size:
                for earlier, other in enumerate(before):
                    slope[part, earlier] = np.einsum("ni,ni->n", own.by_memory, other.followed)
                # What was remembered before is in part forgotten.
                before = [replace(b, followed=b.followed * own.kept) for b in before] + [own]
            memory = self.memories[part]
        rows = np.einsum("ijn,jkn->ikn", self.taken, slope)
        rows[range(_PARTS), range(_PARTS)] += 1.0
        columns = np.stack([_cross(rows[i], rows[j]) for i, j in zip(_NEXT, _LAST, strict=True)])
        step = np.einsum("ikn,in->kn", columns, self.off)
        return np.asarray(step / np.sum(rows[0] * columns[0], axis=0))


def _at(turn: Array, wanted: Array, taken: Array, element: Element, memory: Array) -> _Active:
    torque, memories = np.empty_like(turn), [memory]
    for part, lasts_s in enumerate(STEPS.lasts_s):
        torque[part], _ = element.resist(turn[part], memories[-1])
        memories.append(element.remember(turn[part], memories[-1], lasts_s))
    return _Active(
        turn=turn,
        wanted=wanted,
        taken=taken,
        element=element,
        memory=memory,
        torque=torque,
        memories=memories[1:],
        off=turn - wanted + np.einsum("ijn,jn->in", taken, torque),
    )


def _cross(a: Array, b: Array) -> Array:
    """Of (3, n)."""
    return np.asarray(a[_NEXT] * b[_LAST] - a[_LAST] * b[_NEXT])
