"""Whether what an effect explains recurs from posture to posture.

Errors of a model that is wrong in its form are alike within a posture and differ between postures.
So postures are what counts as independent: how much better each is foretold from the others with an
effect is one draw, and Student's t tells how surely their mean is above zero.

References
----------
Vuong, Econometrica 57 (1989) 307: two models that may both be wrong, by what each observation has.
Cameron and Miller, J. Human Resources 50 (2015) 317, section VI: few clusters, t of G - 1.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy

from armodal.analyzer.gap.model.effect import Instance

__all__ = ["recurrence"]


def recurrence(instance: Instance, gains: Mapping[str, float]) -> float:
    """Probability that further postures too are foretold better with an effect.

    Parameters
    ----------
    instance
        The effect: one of a single posture recurs nowhere, and is not judged by this.
    gains
        Of the log density of each posture's data, foretold from the others; of two at least.
    """
    if instance.of_one_posture:
        return 1.0
    each = np.array([*gains.values()])
    scatter = float(each.std(ddof=1) / np.sqrt(len(each)))
    if scatter == 0.0:
        return 1.0 if each.mean() > 0.0 else 0.0
    return float(scipy.special.stdtr(len(each) - 1, each.mean() / scatter))
