"""Whether what an effect explains recurs from posture to posture.

Errors of a model that is wrong in its form are alike within a posture and differ between postures.
So postures are what counts as independent: by how much an effect lowers the misfit of each is one
draw, and Student's t tells how surely their mean is above zero.

References
----------
Vuong, Econometrica 57 (1989) 307: two models that may both be wrong, by what each observation has.
Cameron and Miller, J. Human Resources 50 (2015) 317, section VI: few clusters, t of G - 1.
"""

from __future__ import annotations

import numpy as np
import scipy

from armodal.analyzer.gap.inference.fit import Fit, Stage

__all__ = ["recurrence"]


def recurrence(stage: Stage, without: Fit, fit: Fit) -> float:
    """Probability that an effect lowers the misfit of further postures too.

    Parameters
    ----------
    stage
        Lines that both were fitted to, of two postures at least.
    without, fit
        The model before, and with one effect more: one of a single posture recurs nowhere, and is
        not judged by this.
    """
    if fit.last.of_one_posture:
        return 1.0
    gains: dict[str, float] = {}
    for lines, before, after in zip(stage.lines, without.misfit, fit.misfit, strict=True):
        gains[lines.name] = gains.get(lines.name, 0.0) + before - after
    each = np.array([*gains.values()])
    scatter = float(each.std(ddof=1) / np.sqrt(len(each)))
    if scatter == 0.0:
        return 1.0 if each.mean() > 0.0 else 0.0
    return float(scipy.special.stdtr(len(each) - 1, each.mean() / scatter))
