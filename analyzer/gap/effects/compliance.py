"""What several compliant effects share: a compliance and its loss as parameters."""

from __future__ import annotations

from analyzer.gap.ordinary import Ordinary
from analyzer.gap.space import Parameter

__all__ = ["compliance_parameter", "loss_parameter"]

_LOSS_MEAN_S, _LOSS_STD_S = 4e-5, 8e-5  # damping over stiffness: 1.3 % at 100 Hz, loosely


def compliance_parameter(name: str, ordinary: Ordinary, *, scale: float = 1.0) -> Parameter:
    """A rotational compliance of at most some ten times a joint's, rad/(N m)."""
    return Parameter(name=name, mean=0.0, std=3.0 * scale * ordinary.compliance, low=0.0)


def loss_parameter(name: str) -> Parameter:
    """Damping over stiffness of a compliance, s."""
    return Parameter(name=name, mean=_LOSS_MEAN_S, std=_LOSS_STD_S, low=0.0)
