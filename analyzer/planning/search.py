"""Search of the joint ranges for postures that leave one joint alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from armodal.analyzer.planning.clearance import Clearance, clear_postures
from armodal.analyzer.planning.selectivity import worst_coupling
from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.postures import random_postures
from armodal.analyzer.workspace.spectrum import ElasticJoints
from armodal.protocols.errors import EstimateError

__all__ = ["isolating_postures"]

Array = npt.NDArray[np.float64]

N_RANDOM = 60_000
N_KEPT = 24
ROUNDS = 10
CHILDREN = 100
N_LIKE = 4  # kept of postures that lie close together
N_VARIOUS = 12  # and of such that lie apart
AMONG = 600  # of the most selective random postures
APART_RAD = 0.5  # in some joint, of postures that are not alike
FIRST_STEP = 0.1  # of a joint's range, one standard deviation; shrinks by half each round


def isolating_postures(
    batch: ArmBatch,
    elastic: ElasticJoints,
    clearance: Clearance,
    rng: np.random.Generator,
    progress: Callable[[int, int], None] | None = None,
) -> list[Array]:
    """For every elastic joint, postures in which its couplings are smallest.

    Random postures first; then the best are moved by ever smaller random steps.

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
    chosen = np.array(elastic.joints)
    low, high = np.array([joint.range_rad for joint in batch.arm.joints]).T
    start = random_postures(batch.arm, N_RANDOM, rng, still=(0,))
    start = start[clear_postures(batch, start, clearance)]
    if not len(start):
        raise EstimateError(
            f"no posture of arm '{batch.arm.name}' within its joint ranges is clear of floor and "
            "base; check the ranges, the points' positions and the clearance"
        )

    def measure(q: Array) -> Array:
        return worst_coupling(batch.mass(q)[chosen[:, None], chosen])

    first = measure(start)
    found = []
    for i in range(len(chosen)):
        best = start[np.argsort(first[i])[:N_KEPT]]
        step = FIRST_STEP * (high - low)
        step[0] = 0.0
        for _ in range(ROUNDS):
            moved = np.repeat(best, CHILDREN, axis=0)
            moved = np.clip(moved + step * rng.normal(size=moved.shape), low, high)
            moved = np.concatenate([best, moved[clear_postures(batch, moved, clearance)]])
            best = moved[np.argsort(measure(moved)[i], kind="stable")[:N_KEPT]]
            step = step / 2
        found.append(np.concatenate([best[:N_LIKE], _various(start[np.argsort(first[i])])]))
        if progress:
            progress(i + 1, len(chosen))
    return found


def _various(postures: Array) -> Array:
    """The first postures of a list that lie apart from one another."""
    kept: list[Array] = []
    for q in postures[:AMONG]:
        if all(np.abs(q - other).max() > APART_RAD for other in kept):
            kept.append(q)
        if len(kept) == N_VARIOUS:
            break
    return np.array(kept)
