"""Whether an effect is large enough to be worth a name."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.confidence import TWO_SIDED_95
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.inference.intervals import intervals
from armodal.analyzer.gap.inference.misfit import misfit_per_line
from armodal.analyzer.gap.model.effect import Instance

__all__ = ["MOST", "is_material", "matters"]

_MOVED = 0.05  # of a joint's stiffness: as much compliance as makes a joint a released one
MOST = 0.5  # of a misfit: what explains as much explains more than all others together


def is_material(fit: Fit, instance: Instance, phi: float) -> bool:
    """Whether what the data tell of an effect's size is worth a name.

    A point's place off by 2 cm +- 8 along a way that no hit tells is off by nothing there.
    """
    return instance.is_material({**fit.values, **_told(fit, instance, phi)})


def _told(fit: Fit, instance: Instance, phi: float) -> dict[str, float]:
    """A size in several parts with what its 95 % interval lets be nothing taken as nothing.

    Along the principal directions of the parts' covariance, since parts may be told together
    that are not told singly. All parts of one effect have one unit.
    """
    own = intervals(fit, instance.sizes, phi)
    told = {name: 0.0 if i.low <= 0.0 <= i.high else i.value for name, i in own.items()}
    free = [name for name in own if fit.free[fit.space.index[name]]]
    if len(free) < 2:
        return told
    at = [fit.space.index[name] for name in free]
    scale = np.array([fit.space.parameters[i].std for i in at])
    covariance = fit.covariance(phi)[np.ix_(at, at)] * np.outer(scale, scale)
    variances, directions = np.linalg.eigh(covariance)
    along = directions.T @ [own[name].value for name in free]
    along[np.abs(along) <= TWO_SIDED_95 * np.sqrt(variances)] = 0.0
    return told | dict(zip(free, (directions @ along).tolist(), strict=True))


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
