"""How many mountings share what an effect brings.

The hits of one mounting err together: where a mode is hardly excited they say another size of
it, on all its lines and axes. A term with a resonance of its own can follow a few of them on one
peak of one posture, and gains as if its lines told independently. What is truly there is told by
most mountings that move.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.fit import Fit, Stage

__all__ = ["is_shared", "mountings_worth"]

Array = npt.NDArray[np.float64]


def is_shared(stage: Stage, without: Fit, better: Fit) -> bool:
    """Whether as many mountings as its last effect asks for bring what a fit gains."""
    least = better.last.effect.least_shared
    return not least or mountings_worth(stage, without, better) >= least


def mountings_worth(stage: Stage, without: Fit, better: Fit) -> float:
    """Return (sum d)^2 / sum d^2 of what each mounting's chi^2 / 2 falls by, d.

    n where n mountings bring the same and the others nothing; zero where nothing is gained. The
    square of Vuong's statistic (Econometrica 57 (1989) 307, Theorem 5.1) with a mounting for one
    draw and its variance about zero.
    """
    gains = _by_mounting(stage, without) - _by_mounting(stage, better)
    total = float(gains.sum())
    return total**2 / float(gains @ gains) if total > 0.0 else 0.0


def _by_mounting(stage: Stage, fit: Fit) -> Array:
    """chi^2 / 2 of every mounting of every posture, its soft and hard hits together."""
    found: dict[tuple[str, int, int], float] = {}
    for rows, together in stage.once(fit.hypothesis, range(len(stage.lines))):
        y = together.response(fit.hypothesis, fit.values).values
        for p, row in rows:
            own = stage.lines[p]
            places = zip(own.sensor_point.tolist(), own.hit_point[own.hit].tolist(), strict=True)
            costs = stage.weighings[p].cost_by_mounting(y[row])
            for place, cost in zip(places, costs.tolist(), strict=True):
                key = own.name, *place
                found[key] = found.get(key, 0.0) + cost
    return np.array([found[key] for key in sorted(found)])
