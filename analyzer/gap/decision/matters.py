"""Whether an effect is large enough to be worth a name."""

from __future__ import annotations

from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.inference.intervals import intervals
from armodal.analyzer.gap.inference.misfit import misfit_per_line
from armodal.analyzer.gap.model.effect import Instance

__all__ = ["MOST", "is_material", "matters"]

_MOVED = 0.05  # of a joint's stiffness: as much compliance as makes a joint a released one
MOST = 0.5  # of a misfit: what explains as much explains more than all others together


def is_material(fit: Fit, instance: Instance, phi: float) -> bool:
    """Whether an effect's size is worth a name: of several parts the largest that the data tell.

    A point's place off by 2 cm +- 8 along a way that no hit tells is off by nothing there.
    """
    told = [
        name
        for name, own in intervals(fit, instance.sizes, phi).items()
        if not own.low <= 0.0 <= own.high
    ]
    untold = {name: 0.0 for name in instance.sizes if told and name not in told}
    return instance.is_material({**fit.values, **untold})


def matters(stage: Stage, without: Fit, fit: Fit, instance: Instance, phi: float) -> bool:
    """Whether an effect is large enough to be worth a name, or most of what is missing without it.

    What a size means is known of joints and links. Of what acts at an unknown lever, or where the
    hits hardly move anything else, the misfit tells it better, or a joint's stiffness that would be
    told wrongly without it.
    """
    if is_material(fit, instance, phi) or _moves_stiffness(without, fit, phi):
        return True
    return misfit_per_line(stage, fit) < (1.0 - MOST) * misfit_per_line(stage, without)


def _moves_stiffness(without: Fit, fit: Fit, phi: float) -> bool:
    """Whether a joint's stiffness leaves its interval with an effect, and by a part that counts."""
    told = intervals(without, [n for n in without.space.index if n.startswith("ln k ")], phi)
    return any(
        not own.low <= fit.values[name] <= own.high and abs(fit.values[name] - own.value) > _MOVED
        for name, own in told.items()
    )
