"""What several compliant effects share: a compliance as a parameter."""

from __future__ import annotations

from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["compliance_parameter"]

_WIDE = 3.0  # of the drive's compliance


def compliance_parameter(
    name: str, ordinary: Ordinary, joint: int, *, length_m: float | None = None
) -> Parameter:
    """A rotational compliance of at most some ten times the joint's, over a length if one is given.

    rad/(N m), or rad/(N m²).
    """
    std, unit = _WIDE * ordinary.scale(joint), "rad/(N m)"
    if length_m is not None:
        std, unit = std / length_m, "rad/(N m²)"
    return Parameter(name=name, unit=unit, mean=0.0, std=std, low=0.0)
