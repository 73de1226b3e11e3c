"""A joint followed step by step while a torque of its own law acts on it.

With x_0 the turn that a linear model foretells and g the turn by a unit impulse of torque,

    x(t) = x_0(t) - int g(t - u) tau(x(u), ...) du ,

one equation however many coordinates the arm has. The two parts of a step depend on each other and
are solved together.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.model.joint_laws import Element
from armodal.analyzer.gap.model.steps import STEPS

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
    _, n_steps, parts, _ = by_steps.shape
    n = len(free)
    coming = free.reshape(n, n_steps, parts).copy()
    turn, torque = np.empty_like(coming), np.empty_like(coming)
    last, memory = np.zeros(n), np.zeros((n, element.n_memory))
    near = by_steps[groups, :_BLOCK]  # (n, _BLOCK, PARTS, PARTS)
    rows = [np.flatnonzero(groups == p) for p in range(len(by_steps))]
    for begin in range(0, n_steps, _BLOCK):
        end = min(begin + _BLOCK, n_steps)
        if begin:
            ago = np.arange(begin, end)[:, None] - np.arange(begin)
            for own, of_steps in zip(rows, by_steps, strict=True):
                far = of_steps[ago].transpose(0, 2, 1, 3).reshape(-1, begin * parts)
                taken = torque[own, :begin].reshape(len(own), -1) @ far.T
                coming[own, begin:end] -= taken.reshape(len(own), -1, parts)
        for at in range(begin, end):
            wanted = coming[:, at]
            if at > begin:
                back = near[:, at - begin : 0 : -1]
                wanted = wanted - np.einsum("nkij,nkj->ni", back, torque[:, begin:at])
            turn[:, at], torque[:, at], memory = _step(last, wanted, near[:, 0], element, memory)
            last = turn[:, at, -1]
    return turn.reshape(n, -1), torque.reshape(n, -1)


def _step(
    last: Array, wanted: Array, taken: Array, element: Element, memory: Array
) -> tuple[Array, Array, Array]:
    """Turns and torques (n, 2) of both parts of a step, and what is remembered after it.

    Newton's steps from the last turn; where one would go past the corner of a slider and further
    from the solution it is halved.
    """
    first_s, second_s = STEPS.lasts_s
    turn = np.stack([last, last], axis=1)
    halfway, torque, off = _off(turn, wanted, taken, element, memory)
    for _ in range(_MOST_TURNS):
        first = element.tangent(turn[:, 0], memory, first_s)
        second = element.tangent(turn[:, 1], halfway, second_s)
        slope = np.zeros((len(turn), 2, 2))
        slope[:, 0, 0], slope[:, 1, 1] = first.by_turn, second.by_turn
        slope[:, 1, 0] = np.sum(second.by_memory * first.followed, axis=1)
        (a, b), (c, d) = np.moveaxis(np.eye(2) + taken @ slope, 0, 2)
        step = np.stack([d * off[:, 0] - b * off[:, 1], a * off[:, 1] - c * off[:, 0]], axis=1)
        step /= (a * d - b * c)[:, None]
        small = _ROUNDING * np.abs(turn - step).max()
        before, part = np.sum(off**2, axis=1), np.ones(len(turn))
        for _ in range(_HALVED):
            there = turn - part[:, None] * step
            halfway, torque, off = _off(there, wanted, taken, element, memory)
            worse = (np.sum(off**2, axis=1) >= before) & (before > small**2)
            if not worse.any():
                break
            part[worse] *= 0.5
        moved = np.abs(there - turn).max()
        turn = there
        # False of what is no number: that is told by who asked.
        if not moved > small:
            break
    return turn, torque, element.remember(turn[:, 1], halfway, second_s)


def _off(
    turn: Array, wanted: Array, taken: Array, element: Element, memory: Array
) -> tuple[Array, Array, Array]:
    """What is remembered halfway, the torques (n, 2), and how far turns are off what they leave."""
    halfway = element.remember(turn[:, 0], memory, STEPS.lasts_s[0])
    torque = np.empty_like(turn)
    torque[:, 0], _ = element.resist(turn[:, 0], memory)
    torque[:, 1], _ = element.resist(turn[:, 1], halfway)
    return halfway, torque, turn - wanted + np.einsum("nij,nj->ni", taken, torque)
