"""The first page of an arm's report: the answer, on one sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.records import GapResult, Gate
from armodal.analyzer.identification.records import Identification
from armodal.analyzer.report.answer import Finding, findings
from armodal.analyzer.report.arm_svg import MarkedAxis, found_svg
from armodal.analyzer.report.check_rows import CheckRow, check_rows
from armodal.analyzer.report.facts import Facts, facts, loss_warnings
from armodal.analyzer.report.marked_effects import marked_effects
from armodal.analyzer.report.next_steps import next_steps
from armodal.analyzer.report.stiffness_rows import Stiffness, stiffness_rows
from armodal.analyzer.report.words import plus_minus
from armodal.protocols.session.records import Session

__all__ = ["FirstPage", "PredictedMode", "first_page"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedMode:
    """A mode of a posture kept for validation: computed and measured."""

    posture: str
    predicted_hz: float
    measured_hz: float | None  # None where no measured mode has this shape

    @property
    def difference(self) -> float | None:
        """Relative, of the computed from the measured frequency."""
        return None if self.measured_hz is None else self.predicted_hz / self.measured_hz - 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstPage:
    """What stands on it."""

    facts: Facts
    warnings: tuple[str, ...]
    findings: tuple[Finding, ...]
    arm: str  # SVG; empty where no posture has joint angles
    arm_posture: str
    stiffness: tuple[Stiffness, ...]
    stiffness_of_gap: bool
    foretold: tuple[PredictedMode, ...]
    checks: tuple[CheckRow, ...]
    next: tuple[str, ...]


def first_page(
    session: Session,
    result: Identification,
    superset: Superset,
    gap: GapResult | None,
    gates: Sequence[Gate],
) -> FirstPage:
    """Put together what the first page says.

    Parameters
    ----------
    gates
        Checks of the measurement; empty where none were made.
    """
    checks = check_rows(gates, [posture.name for posture in session.header.plan.postures])
    incomplete = () if session.complete else ("Some planned points lack their hits.",)
    drawn = next((frf for frf in result.frfs if frf.joints_rad is not None), None)
    arm = ""
    if drawn is not None and drawn.joints_rad is not None:
        axes, places = _marked(superset, result, gap)
        arm = found_svg(superset, drawn.joints_rad, axes, places)
    return FirstPage(
        facts=facts(session),
        warnings=(*incomplete, *session.warnings, *loss_warnings(session)),
        findings=findings(result, gap),
        arm=arm,
        arm_posture="" if drawn is None else drawn.posture,
        stiffness=stiffness_rows(result, gap),
        stiffness_of_gap=gap is not None and bool(gap.joint_stiffness_ranges),
        foretold=_foretold(result, gap),
        checks=checks,
        next=next_steps(session, checks, gap),
    )


def _marked(
    superset: Superset, result: Identification, gap: GapResult | None
) -> tuple[tuple[MarkedAxis, ...], tuple[str, ...]]:
    """Axes to draw, and names of joints and links to mark."""
    if gap is None:
        return tuple(
            MarkedAxis(
                link=axis.link,
                direction_link=axis.direction_link,
                point_link_m=axis.point_link_m,
                label=f"{axis.link}: stiffness "
                f"{plus_minus(axis.k_n_m_per_rad, axis.k_std + axis.k_std_model)[0]} N m/rad",
            )
            for axis in result.axes
        ), ()
    return marked_effects(superset, gap.effects)


def _foretold(result: Identification, gap: GapResult | None) -> tuple[PredictedMode, ...]:
    if gap is not None:
        rows = gap.gap_after or gap.gap_before
        return tuple(
            PredictedMode(posture=row.posture, predicted_hz=m.model_hz, measured_hz=m.measured_hz)
            for row in rows
            if row.held_out
            for m in row.modes
        )
    return tuple(
        PredictedMode(
            posture=row.posture, predicted_hz=row.predicted_hz, measured_hz=row.measured_hz
        )
        for row in result.validation
    )
