"""Statistics over random postures: file 002, Figs. 3, 12 and 13, for any arm."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass
from itertools import islice

import numpy as np

from armodal.analyzer.workspace.batch import ArmBatch
from armodal.analyzer.workspace.moments import Moments, moments_of
from armodal.analyzer.workspace.postures import chunk_sizes, random_postures
from armodal.analyzer.workspace.spectrum import ElasticJoints, spectrum_of_mass
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["WorkspaceStudy", "study_workspace"]

IN_FLIGHT = 64  # chunks handed to an executor at once, so that memory stays flat


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkspaceStudy:
    """Statistics over random postures of an arm."""

    arm: str
    n_postures: int
    seed: int
    still: tuple[int, ...]  # joints left at zero
    moving: tuple[int, ...]  # joints drawn at random
    mass: Moments  # of |M_ij|, (n_joints, n_joints), kg m²
    elastic: ElasticJoints
    f_hz: Moments  # (n_modes,)
    damping_ratio: Moments  # (n_modes,)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Chunk:
    arm: Arm
    batch: ArmBatch
    elastic: ElasticJoints
    n: int
    seed: tuple[int, int]
    still: tuple[int, ...]


def study_workspace(
    arm: Arm,
    elastic: ElasticJoints,
    n_postures: int,
    *,
    seed: int = 0,
    still: tuple[int, ...] = (),
    batch: ArmBatch | None = None,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> WorkspaceStudy:
    """Mass matrix, frequencies and damping over random postures within the joint ranges.

    Parameters
    ----------
    seed
        The postures depend on it and on nothing else, however the work is divided.
    still
        Joints (0-based) left at zero.
    batch
        The arm prepared for many postures, with its effects; the plain arm when omitted.
    executor
        Any `concurrent.futures.Executor` (threads, processes, a Dask client's); none runs here.
    progress
        Called with postures done and wanted.

    Raises
    ------
    ArmError
        If the number of postures is not positive.
    """
    if n_postures < 1:
        raise ArmError(f"wanted at least one posture, got {n_postures}")
    prepared = batch or ArmBatch(arm)
    chunks = (
        _Chunk(arm=arm, batch=prepared, elastic=elastic, n=n, seed=(seed, number), still=still)
        for number, n in enumerate(chunk_sizes(n_postures))
    )
    total: tuple[Moments, Moments, Moments] | None = None
    for part in _run(executor, chunks):
        total = (
            part
            if total is None
            else (total[0].joined(part[0]), total[1].joined(part[1]), total[2].joined(part[2]))
        )
        if progress:
            progress(total[0].count, n_postures)
    if total is None:
        raise ArmError("no posture was evaluated")
    return WorkspaceStudy(
        arm=arm.name,
        n_postures=n_postures,
        seed=seed,
        still=still,
        moving=tuple(i for i in range(len(arm.joints)) if i not in still),
        mass=total[0],
        elastic=elastic,
        f_hz=total[1],
        damping_ratio=total[2],
    )


def _run(
    executor: Executor | None, chunks: Iterable[_Chunk]
) -> Iterator[tuple[Moments, Moments, Moments]]:
    if executor is None:
        yield from map(_evaluate, chunks)
        return
    rest = iter(chunks)
    while window := list(islice(rest, IN_FLIGHT)):
        yield from executor.map(_evaluate, window)


def _evaluate(chunk: _Chunk) -> tuple[Moments, Moments, Moments]:
    rng = np.random.default_rng(chunk.seed)
    joints_rad = random_postures(chunk.arm, chunk.n, rng, still=chunk.still)
    of_joints, mass = chunk.batch.masses(joints_rad)
    modes = spectrum_of_mass(mass, chunk.elastic)
    return (
        moments_of(np.abs(of_joints), axis=2),
        moments_of(modes.f_hz, axis=0),
        moments_of(modes.damping_ratio, axis=0),
    )
