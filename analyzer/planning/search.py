"""Search of the joint ranges for postures that leave one joint alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from armodal.analyzer.planning.clearance import Clearance, clear_postures
from armodal.analyzer.planning.equations import PlannedArm
from armodal.analyzer.planning.selectivity import worst_coupling
from armodal.analyzer.workspace.postures import random_postures
from armodal.protocols.errors import EstimateError

__all__ = ["Free", "isolating_postures"]

Array = npt.NDArray[np.float64]

Free = Callable[[Array], npt.NDArray[np.bool_]]

N_RANDOM = 60_000
CHECKED_AT_ONCE = 32
N_KEPT = 24
ROUNDS = 10
CHILDREN = 100
N_LIKE = 4  # kept of postures that lie close together
N_VARIOUS = 12  # and of such that lie apart
AMONG = 600  # of the most selective random postures
APART_RAD = 0.5  # in some joint, of postures that are not alike
FIRST_STEP = 0.1  # of a joint's range, one standard deviation; shrinks by half each round


def isolating_postures(
    planned: PlannedArm,
    clearance: Clearance,
    rng: np.random.Generator,
    progress: Callable[[int, int], None] | None = None,
    *,
    free: Free | None = None,
) -> list[Array]:
    """For every elastic joint, postures in which its couplings are smallest.

    Random postures first; then the best are moved by ever smaller random steps.

    Parameters
    ----------
    free
        Tells which postures (n, n_joints) the arm's bodies leave free, (n,); asked for the best
        ones alone, since it takes long.

    Returns
    -------
    list of (n, n_joints) float64
        By elastic joint: the most selective posture found, others like it, then postures of other
        kinds; joint 1 at zero, since it turns the whole arm.

    Raises
    ------
    EstimateError
        If no posture within the joint ranges is clear of floor and base.
    """
    batch = planned.batch
    low, high = np.array([joint.range_rad for joint in batch.arm.joints]).T
    start = random_postures(batch.arm, N_RANDOM, rng, still=(0,))
    start = start[clear_postures(batch, start, clearance)]
    if not len(start) or not len(_first_free(start, free, 1)):
        raise EstimateError(
            f"no posture of arm '{batch.arm.name}' within its joint ranges is clear of floor and "
            "base; check the ranges, the points' positions and the clearance"
        )

    def measure(q: Array) -> Array:
        return worst_coupling(planned.joint_mass(q))

    first = measure(start)
    found = []
    for i in range(len(planned.elastic.joints)):
        ranked = start[np.argsort(first[i])]
        best = _first_free(ranked, free, N_KEPT)
        step = FIRST_STEP * (high - low)
        step[0] = 0.0
        for _ in range(ROUNDS):
            moved = np.repeat(best, CHILDREN, axis=0)
            moved = np.clip(moved + step * rng.normal(size=moved.shape), low, high)
            moved = np.concatenate([best, moved[clear_postures(batch, moved, clearance)]])
            moved = moved[np.argsort(measure(moved)[i], kind="stable")]
            best = _first_free(moved, free, N_KEPT)
            step = step / 2
        found.append(np.concatenate([best[:N_LIKE], _various(ranked, free)]))
        if progress:
            progress(i + 1, len(planned.elastic.joints))
    return found


def _first_free(postures: Array, free: Free | None, wanted: int) -> Array:
    """The first free postures of a list, at most `wanted`."""
    if free is None:
        return postures[:wanted]
    kept: list[Array] = []
    found = 0
    for begin in range(0, len(postures), CHECKED_AT_ONCE):
        some = postures[begin : begin + CHECKED_AT_ONCE]
        kept.append(some[free(some)])
        found += len(kept[-1])
        if found >= wanted:
            break
    return np.concatenate(kept)[:wanted] if kept else postures[:0]


def _various(postures: Array, free: Free | None) -> Array:
    """The first free postures of a list that lie apart from one another."""
    kept: list[Array] = []
    for q in postures[:AMONG]:
        apart = all(np.abs(q - other).max() > APART_RAD for other in kept)
        if apart and (free is None or free(q[None])[0]):
            kept.append(q)
        if len(kept) == N_VARIOUS:
            break
    return np.array(kept).reshape(-1, postures.shape[1])
