"""Rigid-link check: FRFs of triaxial points on one link have to move as one rigid body.

Every fault of the library is fitted beside every ordinary error (`rigid_statistics`); the check
names one only if it explains the data far better than ordinary errors do, no fault of another name
or place does nearly as well, it is large enough to matter, and what it leaves is noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.checks.candidates import Candidate, discrete, relaxed
from armodal.analyzer.checks.decision import combined_finding, decide
from armodal.analyzer.checks.records import Fault, Finding, Outcome
from armodal.analyzer.checks.rigid_design import RigidDesign
from armodal.analyzer.checks.rigid_statistics import (
    OrdinaryErrors,
    RigidFit,
    RigidStatistics,
    fit_rigid,
    screen,
)
from armodal.analyzer.checks.sensor_hypotheses import Hypothesis, hypotheses
from armodal.protocols.arrays import frozen_array

__all__ = ["NamedFault", "RigidLinkResult", "named_fault", "rigid_link"]

Array = npt.NDArray[np.float64]
NamedFault = tuple[Fault | None, tuple[str, ...]]  # at these points; none: in the roving sensor

POINTS_TO_PLACE = 3  # on a link, before one of them is said to be displaced
FITTED = 32  # discrete hypotheses that survive the screen


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidLinkResult:
    """The finding, and rivals of what was found first, best first.

    `faint` says that a finding that cannot tell stays below the bar of a name.
    """

    finding: Finding
    first: Finding  # without what was found beside it
    named: frozenset[NamedFault]  # all faults that the finding names: one, or two at once
    measured: tuple[str, ...]
    candidates: tuple[Candidate, ...]
    residual_per_dof: float
    faint: bool
    scale: float  # that costs are divided by before they are compared, at least 1


def rigid_link(
    posture: str,
    measured: tuple[str, ...],
    stats: RigidStatistics,
    design: RigidDesign,
    errors: OrdinaryErrors,
    *,
    sat_at: tuple[str, ...] | None = None,
) -> RigidLinkResult:
    """Judge one posture.

    Where a discrete fault is found, it is undone and the rest judged once more: a second fault is
    told too.

    Parameters
    ----------
    measured
        (n,) ids of the points `stats` holds, in its order, all on moving links.
    sat_at
        Where the sensor is known to have sat instead; by default at `measured`.
    """
    index = np.array([design.points.index(point) for point in sat_at or measured])
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
        found.append(discrete(h, fit))
    free, gain_std = relaxed(fits[0], placeable)
    found += free
    found.sort(key=lambda c: c.cost)
    per_dof = found[0].residual / max(dof, 1.0)
    scale = max(1.0, per_dof)
    decision = decide(posture, measured, found, dof, constraints, gain_std)
    finding = decision.finding
    named = {named_fault(measured, found[0])} if finding.outcome is Outcome.FAULT else set()
    if decision.undo is not None and sat_at is None:
        first = decision.undo
        h = next(h for h in all_hypotheses if (h.text, h.at) == (first.text, first.at))
        undone = replace(
            stats,
            data=frozen_array(np.einsum("pab,pbc->pac", h.correction, stats.data), np.float64),
            deviations=frozen_array(
                np.einsum("pab,pdbc->pdac", h.correction, stats.deviations), np.float64
            ),
        )
        where = tuple(design.points[i] for i in h.rows)
        rest = rigid_link(posture, measured, undone, design, errors, sat_at=where)
        finding = combined_finding(finding, rest.finding, measured, first)
        per_dof = min(per_dof, rest.residual_per_dof)
        if rest.finding.outcome is Outcome.FAULT:
            named = {named_fault(measured, first), *rest.named}
    return RigidLinkResult(
        finding=finding,
        first=decision.finding,
        named=frozenset(named),
        measured=measured,
        candidates=tuple(found),
        residual_per_dof=per_dof,
        faint=decision.faint,
        scale=scale,
    )


def named_fault(measured: tuple[str, ...], c: Candidate) -> NamedFault:
    """Return a candidate's fault with the names of its points."""
    return c.fault, () if c.everywhere else tuple(measured[p] for p in c.at)


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
