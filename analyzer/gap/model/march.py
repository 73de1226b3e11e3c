"""A joint followed step by step while a torque of its own law acts on it.

With x_0 the turn that a linear model foretells and g the turn by a unit impulse of torque,

    x(t) = x_0(t) - int g(t - u) tau(x(u), ...) du ,

one equation however many coordinates the arm has. The two parts of a step depend on each other and
are solved together.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.joint_laws import Element, rows_of
from armodal.analyzer.gap.model.steps import PARTS, STEPS

__all__ = ["march"]

Array = npt.NDArray[np.float64]

_BLOCK = 16
_ROUNDING = 1e-9  # of the largest turn: a step of the solution that changes nothing
_MOST_TURNS, _HALVED = 50, 8  # of Newton's steps, and how often one is halved


def march(
    by_steps: Array, groups: npt.NDArray[np.int64], free: Array, element: Element
) -> tuple[Array, Array]:
    """Turns and torques (n, PARTS n_steps) of n swings with an element.

    Parameters
    ----------
    by_steps
        (P, n_steps, PARTS, PARTS) of every posture (`Swings.by_steps`).
    groups
        (n,) posture of each swing, ascending.
    free
        (n, PARTS n_steps) turns without it.
    element
        Of n rows.
    """
    n, n_steps = len(free), by_steps.shape[1]
    turn, torque = np.empty_like(free), np.empty_like(free)
    ahead, memory = np.zeros((n, PARTS)), np.zeros((n, element.n_memory))
    # What torques of the steps before do to a step, the last at the end: (n, PARTS _BLOCK, PARTS).
    near = by_steps[groups, _BLOCK - 1 : 0 : -1].swapaxes(2, 3).reshape(n, -1, PARTS)
    taken = by_steps[groups, 0]
    begins = np.searchsorted(groups, np.arange(len(by_steps) + 1))
    for begin in range(0, n_steps, _BLOCK):
        end = min(begin + _BLOCK, n_steps)
        coming = free[:, PARTS * begin : PARTS * end].copy()
        if begin:
            ago = np.arange(begin, end) - np.arange(begin)[:, None]
            for own, of_steps in zip(map(slice, begins, begins[1:]), by_steps, strict=True):
                far = of_steps[ago].transpose(0, 3, 1, 2).reshape(PARTS * begin, -1)
                coming[own] -= torque[own, : PARTS * begin] @ far
        for at in range(begin, end):
            here = slice(PARTS * at, PARTS * (at + 1))
            wanted = coming[:, PARTS * (at - begin) : PARTS * (at - begin + 1)]
            if at > begin:
                before = torque[:, PARTS * begin : here.start]
                wanted = wanted - np.einsum("nk,nki->ni", before, near[:, -before.shape[1] :])
            turn[:, here], torque[:, here], memory = _step(ahead, wanted, taken, element, memory)
            # As fast as in the part before.
            rate = (turn[:, here.stop - 1] - turn[:, here.stop - 2]) / STEPS.lasts_s[1]
            ahead = turn[:, here.stop - 1, None] + rate[:, None] * np.cumsum(STEPS.lasts_s)
    return turn, torque


def _step(
    ahead: Array, wanted: Array, taken: Array, element: Element, memory: Array
) -> tuple[Array, Array, Array]:
    """Turns and torques (n, PARTS) of both parts of a step, and what is remembered after it.

    Newton's steps from `ahead`; where one would go past the corner of a slider and further
    from the solution it is halved. What has found its place is left there.
    """
    turn = ahead
    halfway, torque, off = _off(turn, wanted, taken, element, memory)
    small = _ROUNDING * max(np.abs(turn).max(), np.abs(wanted).max())
    every = np.arange(len(turn))
    own = _Active(
        turn=turn,
        halfway=halfway,
        off=off,
        wanted=wanted,
        taken=taken,
        element=element,
        memory=memory,
    )
    for _ in range(_MOST_TURNS):
        # False of what is no number: that is told by who asked.
        goes_on = np.flatnonzero(np.abs(own.off).max(axis=1) > small)
        if goes_on.size == 0:
            break
        if goes_on.size < len(own.off):
            own, every = own.rows(goes_on), every[goes_on]
        own, own_torque = own.further(small)
        turn[every], halfway[every], torque[every] = own.turn, own.halfway, own_torque
    return turn, torque, element.remember(turn[:, 1], halfway, STEPS.lasts_s[1])


@dataclass(frozen=True, slots=True, kw_only=True)
class _Active:
    """Swings in a step, where they are on the way to its solution."""

    turn: Array  # (n, PARTS)
    halfway: Array  # what is remembered
    off: Array  # (n, PARTS) how far turns are off what their torques leave
    wanted: Array  # (n, PARTS)
    taken: Array  # (n, PARTS, PARTS)
    element: Element
    memory: Array

    def rows(self, rows: npt.NDArray[np.int64]) -> _Active:
        """Return some of them."""
        return _Active(
            turn=self.turn[rows],
            halfway=self.halfway[rows],
            off=self.off[rows],
            wanted=self.wanted[rows],
            taken=self.taken[rows],
            element=rows_of(self.element, rows),
            memory=self.memory[rows],
        )

    def further(self, small: float) -> tuple[_Active, Array]:
        """Return them a step of Newton's on, and their torques (n, PARTS).

        What is so small is nothing.
        """
        step = self._step()
        far = np.sum(self.off**2, axis=1)
        is_off = far > small**2
        part = np.ones(len(far))
        for _ in range(_HALVED):
            turn = self.turn - part[:, None] * step
            halfway, torque, off = _off(turn, self.wanted, self.taken, self.element, self.memory)
            worse = (np.sum(off**2, axis=1) >= far) & is_off
            if not worse.any():
                break
            part[worse] *= 0.5
        return replace(self, turn=turn, halfway=halfway, off=off), torque

    def _step(self) -> Array:
        first_s, second_s = STEPS.lasts_s
        first = self.element.tangent(self.turn[:, 0], self.memory, first_s)
        second = self.element.tangent(self.turn[:, 1], self.halfway, second_s)
        across = np.einsum("ni,ni->n", second.by_memory, first.followed)
        w = self.taken
        a = 1.0 + w[:, 0, 0] * first.by_turn + w[:, 0, 1] * across
        b = w[:, 0, 1] * second.by_turn
        c = w[:, 1, 0] * first.by_turn + w[:, 1, 1] * across
        d = 1.0 + w[:, 1, 1] * second.by_turn
        step = np.empty_like(self.turn)
        step[:, 0] = d * self.off[:, 0] - b * self.off[:, 1]
        step[:, 1] = a * self.off[:, 1] - c * self.off[:, 0]
        return np.asarray(step / (a * d - b * c)[:, None])


def _off(
    turn: Array, wanted: Array, taken: Array, element: Element, memory: Array
) -> tuple[Array, Array, Array]:
    """What is remembered halfway, the torques (n, PARTS), and how far turns are off."""
    halfway = element.remember(turn[:, 0], memory, STEPS.lasts_s[0])
    torque = np.empty_like(turn)
    torque[:, 0], _ = element.resist(turn[:, 0], memory)
    torque[:, 1], _ = element.resist(turn[:, 1], halfway)
    return halfway, torque, turn - wanted + np.einsum("nij,nj->ni", taken, torque)
