"""What several compliant effects share: a compliance as a parameter, and what a bearing loses."""

from __future__ import annotations

from armodal.analyzer.gap.model.interface import loss_factor_parameter
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["bearing_loss", "compliance_parameter"]

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


def bearing_loss(joint: str) -> dict[str, Parameter]:
    """What a joint's bearing loses at all frequencies, by name: as in the null, but told."""
    name = f"bearing loss factor {joint}"
    return {name: loss_factor_parameter(name)}
