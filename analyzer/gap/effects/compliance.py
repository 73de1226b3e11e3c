"""What several compliant effects share: a compliance and its losses as parameters."""

from __future__ import annotations

from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.priors import (
    INTERFACE_FACTOR_MEAN,
    INTERFACE_FACTOR_STD,
    INTERFACE_LOSS_MEAN_S,
    INTERFACE_LOSS_STD_S,
)
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["compliance_parameter", "loss_factor_parameter", "loss_parameter"]

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


def loss_parameter(name: str) -> Parameter:
    """Damping over stiffness of a compliance, s."""
    return Parameter(
        name=name, unit="s", mean=INTERFACE_LOSS_MEAN_S, std=INTERFACE_LOSS_STD_S, low=0.0
    )


def loss_factor_parameter(name: str) -> Parameter:
    """Loss of a compliance that is the same at all frequencies, beside the one that grows."""
    return Parameter(
        name=name,
        unit="",
        mean=INTERFACE_FACTOR_MEAN,
        std=INTERFACE_FACTOR_STD,
        low=0.0,
        untold=0.0,
    )
