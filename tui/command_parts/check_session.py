"""Measurement checks of a session, for `armodal check session`."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.checks import check_session
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.protocols.session.records import Session

__all__ = ["session_checks"]


def session_checks(session: Session) -> tuple[dict[str, Any], Table]:
    """Run the checks; return the findings as plain values and as a table."""
    superset = Superset(session.header.arm)
    findings = check_session(session, estimate_frfs(session, superset), superset)
    table = Table(title="Measurement checks")
    for column in ("check", "posture", "says", "confidence", "what"):
        table.add_column(column)
    rows: list[dict[str, Any]] = []
    for finding in findings:
        rows.append(
            {
                "check": finding.check,
                "posture": finding.posture,
                "outcome": finding.outcome.value,
                "fault": finding.fault.value if finding.fault else None,
                "points": list(finding.points),
                "everywhere": finding.everywhere,
                "confidence": finding.confidence,
                "text": finding.text,
            }
        )
        table.add_row(
            finding.check,
            finding.posture,
            finding.fault.value if finding.fault else finding.outcome.value,
            f"{finding.confidence:.3f}" if finding.confidence > 0.0 else "",
            finding.text,
        )
    return {"checks": rows}, table
