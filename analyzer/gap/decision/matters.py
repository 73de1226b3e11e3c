"""Whether an effect is large enough to be worth a name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from armodal.analyzer.confidence import TWO_SIDED_95
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.inference.intervals import intervals
from armodal.analyzer.gap.inference.misfit import misfit_per_line
from armodal.analyzer.gap.model.effect import Instance

__all__ = ["MOST", "is_material", "matters"]

_MOVED = 0.05  # of a joint's stiffness: as much compliance as makes a joint a released one
MOST = 0.5  # of a misfit: what explains as much explains more than all others together


def is_material(stage: Stage, fit: Fit, instance: Instance, phi: float) -> bool:
    """Whether the data tell that an effect's size is worth a name: the near end of its interval.

    At 95 %. A link that bends by 1.7 % +- 1.2 of its drive may well bend by no more than a sound
    one does, and a point's place off by 2 cm +- 8 along a way that no hit tells is off by nothing
    there.
    """
    # Of an effect: errors that all postures share show in no disagreement.
    spread = max(phi, len({lines.name for lines in stage.lines}))
    sizes = instance.sizes or (instance.size,)
    near = _near_ends(fit, instance, sizes, spread)
    for name, _ in instance.side_sizes:
        near |= _near_ends(fit, instance, (name,), spread)
    return instance.is_material({**fit.values, **near})


def _near_ends(
    fit: Fit, instance: Instance, sizes: Sequence[str], spread: float
) -> dict[str, float]:
    """The end nearer to zero of the 95 % interval of a size, of each of its parts.

    Of what no sound arm has, as it is shaped: over all shapes an interval may reach to zero though
    the data leave no doubt that something is there. Of what every arm has some of, that it is more
    must hold whatever its shape. Along the principal directions of the parts' covariance, since
    parts may be told together that are not told singly. All parts of one size have one unit.
    """
    space = fit.space
    told = fit.free.copy()
    shapes = () if instance.effect.some_is_ordinary else instance.shapes
    told[[space.index[name] for name in shapes if name in space.index]] = False
    names = [name for name in sizes if name in space.index and told[space.index[name]]]
    if not names:
        return {}
    at = [space.index[name] for name in names]
    std = np.array([space.parameters[i].std for i in at])
    covariance = replace(fit, free=told).covariance(spread)[np.ix_(at, at)] * np.outer(std, std)
    variances, directions = np.linalg.eigh(covariance)
    values = np.array([fit.values[name] for name in names])
    along = directions.T @ values
    inwards = np.maximum(np.abs(along) - TWO_SIDED_95 * np.sqrt(variances), 0.0)
    near = directions @ (np.sign(along) * inwards)
    # What one direction alone tells may lie further along a part than the whole.
    return dict(zip(names, np.clip(near, -np.abs(values), np.abs(values)).tolist(), strict=True))


def matters(stage: Stage, without: Fit, fit: Fit, instance: Instance, phi: float) -> bool:
    """Whether an effect is large enough to be worth a name, or most of what is missing without it.

    What a size means is known of joints and links. Of what acts at an unknown lever, or where the
    hits hardly move anything else, the misfit tells it better, or a joint's stiffness that would be
    told wrongly without it.
    """
    if is_material(stage, fit, instance, phi) or _moves_stiffness(without, fit, phi):
        return True
    return misfit_per_line(stage, fit) < (1.0 - MOST) * misfit_per_line(stage, without)


def _moves_stiffness(without: Fit, fit: Fit, phi: float) -> bool:
    """Whether a joint's stiffness leaves its interval with an effect, and by a part that counts."""
    told = intervals(without, [n for n in without.space.index if n.startswith("ln k ")], phi)
    return any(
        not own.low <= fit.values[name] <= own.high and abs(fit.values[name] - own.value) > _MOVED
        for name, own in told.items()
    )
