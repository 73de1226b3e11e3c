"""What an interface loses: a bolted seat, a bearing, a casting, whatever gives way in it.

Metal in metal loses by the same factor at all frequencies, grease and rubber by one that grows.
Whoever fits one form to the other finds a part too soft or an effect too many, so every part that
gives way has both, and no effect has a form that the part without it lacks.
"""

from __future__ import annotations

from armodal.analyzer.gap.model.priors import (
    INTERFACE_FACTOR_MEAN,
    INTERFACE_FACTOR_STD,
    INTERFACE_LOSS_MEAN_S,
    INTERFACE_LOSS_STD_S,
)
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["loss_factor_parameter", "loss_parameter"]


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
