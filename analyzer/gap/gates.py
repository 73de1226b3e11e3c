"""Checks of the measurement as a gap result keeps them."""

from __future__ import annotations

from collections.abc import Iterable

from armodal.analyzer.checks.records import Finding
from armodal.analyzer.gap.records import Gate

__all__ = ["gates_of"]


def gates_of(findings: Iterable[Finding]) -> tuple[Gate, ...]:
    """Return what each check said, with its posture."""
    return tuple(
        Gate(
            check=f"{finding.check} {finding.posture}".strip(),
            outcome=finding.outcome.value,
            words=finding.text,
        )
        for finding in findings
    )
