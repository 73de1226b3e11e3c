"""Faults as they are fitted: discrete ones, and gains and displacements set free."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.checks.records import Fault
from armodal.analyzer.checks.rigid_statistics import Relaxed, RigidFit, fit_relaxed
from armodal.analyzer.checks.sensor_hypotheses import Hypothesis

__all__ = ["Candidate", "describe", "discrete", "relaxed"]

Array = npt.NDArray[np.float64]

MATERIAL_GAIN = 0.05
MATERIAL_SHIFT_M = 0.015
DETERMINED_GAIN = 0.05  # standard deviation beyond which a gain is not named
WIDE_GAIN, WIDE_SHIFT_M = 1.0, 0.3  # what a gain or a displacement set free is allowed
LEAST_CORRECTION, MOST_CORRECTION = 0.3, 3.0  # of a gain: beyond, it is no gain but a dead axis


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A fault and how well it explains the data."""

    fault: Fault | None
    at: tuple[int, ...]
    everywhere: bool
    key: str  # the detail without figures, the same in every posture
    text: str
    cost: float
    residual: float
    material: bool
    continuous: bool  # a gain or a displacement, which errors of aim can look like
    size: float  # gain less one, or displacement in m; 0 where discrete
    std: float  # of the size

    @property
    def name(self) -> tuple[Fault | None, tuple[int, ...]]:
        """What and where, without the detail."""
        return self.fault, (() if self.everywhere else self.at)


def describe(measured: tuple[str, ...], candidate: Candidate) -> str:
    """A candidate in words."""
    if candidate.fault is None:
        return "nothing wrong"
    where = (
        "in the roving sensor, at all points"
        if candidate.everywhere
        else "at point " + " and ".join(measured[p] for p in candidate.at)
    )
    return f"{candidate.fault.value} {where}: {candidate.text}"


def discrete(hypothesis: Hypothesis, fit: RigidFit) -> Candidate:
    """A hypothesis of `hypotheses` with its fit."""
    return Candidate(
        fault=hypothesis.fault,
        at=hypothesis.at,
        everywhere=hypothesis.everywhere,
        key=hypothesis.text,
        text=hypothesis.text,
        cost=fit.cost,
        residual=fit.residual,
        material=True,
        continuous=False,
        size=0.0,
        std=0.0,
    )


def relaxed(null: RigidFit, placeable: list[bool]) -> tuple[list[Candidate], Array]:
    """Gains and displacements set free, one at a time; std of each point's gains (n, 3)."""
    n = len(placeable)
    kinds = len(null.nuisance) // n
    unit = np.eye(len(null.nuisance))
    everyone = tuple(range(n))
    at: list[tuple[int, ...]] = []
    names: list[str] = []
    columns: list[Array] = []
    for p in range(n):
        gains = unit[:, p * kinds + 3 : p * kinds + 6]
        at += [(p,)] * 4
        names += ["gain of x", "gain of y", "gain of z", "gain of all three axes"]
        columns += [*(gains[:, k : k + 1] for k in range(3)), gains.sum(axis=1, keepdims=True)]
    for k, axis in enumerate("xyz"):
        at.append(everyone)
        names.append(f"gain of {axis} beside the other axes,")
        columns.append(unit[:, 3 + k :: kinds].sum(axis=1, keepdims=True))
    free = fit_relaxed(null, columns, WIDE_GAIN)
    found = []
    for where, name, fit in zip(at, names, free, strict=True):
        undone = 1.0 + float(fit.estimate[0])
        if LEAST_CORRECTION <= undone <= MOST_CORRECTION and fit.std[0] < DETERMINED_GAIN:
            gain = 1.0 / undone
            gain_std = gain**2 * float(fit.std[0])
            text = f"{name} {gain:.3f} ± {gain_std:.3f}"
            size = gain - 1.0
            found.append(_free(Fault.GAIN, where, n, name, text, fit, size=size, std=gain_std))
    gain_stds: Array = np.array([[free[4 * p + k].std[0] for k in range(3)] for p in range(n)])
    points = [p for p in range(n) if placeable[p]]
    moved = fit_relaxed(
        null, [unit[:, p * kinds + 6 : p * kinds + 9] for p in points], WIDE_SHIFT_M
    )
    for p, fit in zip(points, moved, strict=True):
        size = float(np.linalg.norm(fit.estimate))
        text = f"it sat {1e3 * size:.0f} mm or more from where the file says"
        std_m = float(np.linalg.norm(fit.std))
        found.append(_free(Fault.WRONG_POINT, (p,), n, "moved", text, fit, size=size, std=std_m))
    return found, gain_stds


def _free(
    fault: Fault,
    at: tuple[int, ...],
    n: int,
    key: str,
    text: str,
    fit: Relaxed,
    *,
    size: float,
    std: float,
) -> Candidate:
    return Candidate(
        fault=fault,
        at=at,
        everywhere=len(at) == n and n > 1,
        key=key,
        text=text,
        cost=fit.cost,
        residual=fit.residual,
        material=abs(size) > (MATERIAL_GAIN if fault is Fault.GAIN else MATERIAL_SHIFT_M),
        continuous=True,
        size=size,
        std=std,
    )
