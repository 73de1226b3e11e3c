"""Rigid-link check: FRFs of triaxial points on one link have to move as one rigid body.

Every fault of the library is fitted beside every ordinary error (`rigid_statistics`); the check
names one only if it explains the data far better than ordinary errors do, no fault of another name
or place does nearly as well, it is large enough to matter, and what it leaves is noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analyzer.checks.records import Fault, Finding, Outcome
from analyzer.checks.rigid_design import RigidDesign
from analyzer.checks.rigid_statistics import (
    OrdinaryErrors,
    RigidFit,
    RigidStatistics,
    fit_relaxed,
    fit_rigid,
    screen,
)
from analyzer.checks.sensor_hypotheses import Hypothesis, hypotheses

__all__ = ["Candidate", "PointSight", "RigidLinkResult", "rigid_link"]

Array = npt.NDArray[np.float64]

CLEARLY_BETTER = 40.0  # of twice the log likelihood ratio, over the scale of the residual
FULL_CONSTRAINTS = 20  # with fewer independent constraints the bar is that much higher
POINTS_TO_PLACE = 3  # on a link, before one of them is said to be displaced
RIVAL_WITHIN = 10.0
ADEQUATE = 1.0  # residual per degree of freedom that noise and local discrepancies may leave
MATERIAL_GAIN = 0.05
MATERIAL_SHIFT_M = 0.015
FITTED = 32  # discrete hypotheses that survive the screen
LEAST_CORRECTION, MOST_CORRECTION = 0.3, 3.0  # of a gain: beyond, it is no gain but a dead axis


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A fault and how well it explains the data."""

    fault: Fault | None
    at: tuple[int, ...]
    everywhere: bool
    text: str
    cost: float
    residual: float
    material: bool

    @property
    def name(self) -> tuple[Fault | None, tuple[int, ...]]:
        """What and where, without the detail."""
        return self.fault, (() if self.everywhere else self.at)


@dataclass(frozen=True, slots=True, kw_only=True)
class PointSight:
    """What the data of one point could show.

    `hidden` are discrete faults at this point that the data would not have excluded;
    `gain_std` the standard deviation of a free gain along each sensor axis.
    """

    point: str
    hidden: tuple[str, ...]
    gain_std: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidLinkResult:
    """The finding, the rivals beside it (best first), and what could have been seen."""

    finding: Finding
    candidates: tuple[Candidate, ...]
    sight: tuple[PointSight, ...]
    residual_per_dof: float


def rigid_link(
    posture: str,
    measured: tuple[str, ...],
    stats: RigidStatistics,
    design: RigidDesign,
    errors: OrdinaryErrors,
) -> RigidLinkResult:
    """Judge one posture.

    Parameters
    ----------
    measured
        (n,) ids of the points `stats` holds, in its order, all on moving links.
    """
    index = np.array([design.points.index(point) for point in measured])
    rows = design.rows[index]
    constraints = 3 * len(index) - int(np.linalg.matrix_rank(rows.reshape(-1, rows.shape[-1])))
    dof = stats.lines * constraints
    on_link = [design.link[i] for i in index]
    placeable = [on_link.count(link) >= POINTS_TO_PLACE for link in on_link]
    all_hypotheses = hypotheses(index, design.points)
    screened = _screen(stats, design, all_hypotheses)
    order = np.argsort(screened, kind="stable")
    fit_these = {0, *(int(i) for i in order[:FITTED])}
    found: list[Candidate] = []
    fits: list[RigidFit] = []
    for i in sorted(fit_these):
        h = all_hypotheses[i]
        fit = fit_rigid(stats, design.rows[h.rows], design.turning[h.rows], h.correction, errors)
        fits.append(fit)
        found.append(
            Candidate(
                fault=h.fault,
                at=h.at,
                everywhere=h.everywhere,
                text=h.text,
                cost=fit.cost,
                residual=fit.residual,
                material=True,
            )
        )
    free, gain_std = _relaxed(fits[0], placeable)
    found += free
    found.sort(key=lambda c: c.cost)
    per_dof = found[0].residual / max(dof, 1.0)
    sight = _sight(measured, found, gain_std)
    return RigidLinkResult(
        finding=_decide(posture, measured, found, dof, constraints),
        candidates=tuple(found),
        sight=sight,
        residual_per_dof=per_dof,
    )


def _screen(stats: RigidStatistics, design: RigidDesign, all_: tuple[Hypothesis, ...]) -> Array:
    """Cost without ordinary errors, of all hypotheses; those with the same rows at once."""
    result = np.empty(len(all_))
    groups: dict[bytes, list[int]] = {}
    for i, h in enumerate(all_):
        groups.setdefault(h.rows.tobytes(), []).append(i)
    for members in groups.values():
        corrections = np.stack([all_[i].correction for i in members])
        result[members] = screen(stats, design.rows[all_[members[0]].rows], corrections)
    return result


def _relaxed(null: RigidFit, placeable: list[bool]) -> tuple[list[Candidate], Array]:
    """Gains and displacements set free, one at a time; std of each point's gains (n, 3)."""
    n = len(placeable)
    kinds = len(null.nuisance) // n
    found: list[Candidate] = []
    std = np.empty((n, 3))

    def add(fault: Fault, at: tuple[int, ...], combos: Array, words: str) -> Array:
        wide = 1.0 if fault is Fault.GAIN else 0.3
        fit = fit_relaxed(null, combos, wide)
        if fault is Fault.GAIN:
            undone = 1.0 + float(fit.estimate[0])
            if not LEAST_CORRECTION <= undone <= MOST_CORRECTION:
                return fit.std
            gain = 1.0 / undone
            material = abs(gain - 1.0) > MATERIAL_GAIN
            text = words.format(gain, gain**2 * float(fit.std[0]))
        else:
            size = float(np.linalg.norm(fit.estimate))
            material = size > MATERIAL_SHIFT_M
            text = words.format(1e3 * size)
        found.append(
            Candidate(
                fault=fault,
                at=at,
                everywhere=len(at) == n and n > 1,
                text=text,
                cost=fit.cost,
                residual=fit.residual,
                material=material,
            )
        )
        return fit.std

    unit = np.eye(len(null.nuisance))
    for p in range(n):
        gains = unit[:, p * kinds + 3 : p * kinds + 6]
        for k, axis in enumerate("xyz"):
            words = f"gain of {axis} {{:.3f}} ± {{:.3f}}"
            std[p, k] = add(Fault.GAIN, (p,), gains[:, k : k + 1], words)[0]
        words = "gain of all three axes {:.3f} ± {:.3f}"
        add(Fault.GAIN, (p,), gains.sum(axis=1, keepdims=True), words)
        shifts = unit[:, p * kinds + 6 : p * kinds + 9]
        if not placeable[p]:
            continue
        add(Fault.WRONG_POINT, (p,), shifts, "it sat {:.0f} mm or more from where the file says")
    everyone = tuple(range(n))
    for k, axis in enumerate("xyz"):
        column = unit[:, 3 + k :: kinds].sum(axis=1, keepdims=True)
        words = f"gain of {axis} {{:.3f}} ± {{:.3f}} beside the other axes"
        add(Fault.GAIN, everyone, column, words)
    return found, std


def _sight(
    measured: tuple[str, ...], found: list[Candidate], gain_std: Array
) -> tuple[PointSight, ...]:
    best = found[0].cost
    hidden: dict[int, list[str]] = {p: [] for p in range(len(measured))}
    for c in found:
        discrete = c.fault in (Fault.AXIS_SWAPPED, Fault.SIGN_FLIPPED)
        if discrete and len(c.at) == 1 and c.cost < best + CLEARLY_BETTER and c is not found[0]:
            hidden[c.at[0]].append(c.text)
    return tuple(
        PointSight(
            point=point,
            hidden=tuple(hidden[p]),
            gain_std=(float(gain_std[p, 0]), float(gain_std[p, 1]), float(gain_std[p, 2])),
        )
        for p, point in enumerate(measured)
    )


def _decide(
    posture: str,
    measured: tuple[str, ...],
    found: list[Candidate],
    dof: float,
    constraints: int,
) -> Finding:
    bar = CLEARLY_BETTER * max(1.0, FULL_CONSTRAINTS / max(constraints, 1))
    null = next(c for c in found if c.fault is None)
    best = found[0]
    scale = max(1.0, best.residual / max(dof, 1.0))
    gain = (null.cost - best.cost) / scale
    rivals = [
        c for c in found if c.name != best.name and (c.cost - best.cost) / scale < RIVAL_WITHIN
    ]

    def finding(outcome: Outcome, text: str, *, confidence: float = 0.0) -> Finding:
        named = outcome is Outcome.FAULT
        return Finding(
            check="rigid link",
            posture=posture,
            outcome=outcome,
            fault=best.fault if named else None,
            points=tuple(measured[p] for p in best.at) if named and not best.everywhere else (),
            everywhere=named and best.everywhere,
            confidence=confidence,
            text=text,
        )

    if dof < 1.0:
        return finding(Outcome.CANNOT_TELL, "no link has enough points")
    if best.fault is None or gain < bar or not best.material:
        if null.residual / dof > ADEQUATE:
            return finding(
                Outcome.CANNOT_TELL,
                "the points do not move as rigid links, and no single fault explains it",
            )
        # Before the data, a fault is as likely as the bar it has to clear says.
        material = [c for c in found if c.material and c.fault is not None]
        margin = bar - max((null.cost - c.cost for c in material), default=0.0) / scale
        return finding(
            Outcome.GOOD,
            "the points move as rigid links within the ordinary errors",
            confidence=float(1.0 / (1.0 + np.exp(-0.5 * margin))),
        )
    if best.residual / dof > ADEQUATE:
        return finding(Outcome.CANNOT_TELL, "something is wrong, and no single fault explains it")
    if rivals:
        words = "; ".join(_describe(measured, c) for c in (best, *rivals[:3]))
        return finding(Outcome.CANNOT_TELL, f"something is wrong, one of: {words}")
    return finding(
        Outcome.FAULT, _describe(measured, best), confidence=_confidence(found, best, scale)
    )


def _describe(measured: tuple[str, ...], c: Candidate) -> str:
    if c.fault is None:
        return "nothing wrong"
    where = (
        "in the roving sensor, at all points"
        if c.everywhere
        else "at point " + " and ".join(measured[p] for p in c.at)
    )
    return f"{c.fault.value} {where}: {c.text}"


def _confidence(found: list[Candidate], chosen: Candidate, scale: float) -> float:
    """Share of the likelihood that candidates of the chosen name hold."""
    least = found[0].cost
    weight = np.exp([-0.5 * (c.cost - least) / scale for c in found])
    same = np.array([c.name == chosen.name for c in found])
    return float(weight[same].sum() / weight.sum())
