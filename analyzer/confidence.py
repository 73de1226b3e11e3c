"""How many deviations of a Gaussian hold 95 %, and what F exceeds with a chance."""

import math
from statistics import NormalDist

__all__ = ["ONE_SIDED_95", "TWO_SIDED_95", "f_exceeded_with"]

TWO_SIDED_95, ONE_SIDED_95 = (NormalDist().inv_cdf(p) for p in (0.975, 0.95))


def f_exceeded_with(chance: float, dof: float) -> float:
    """What F of 2 and `dof` degrees of freedom exceeds with a chance: (1 + 2 F / dof)^(-dof / 2).

    References
    ----------
    Johnson, Kotz, Balakrishnan, Continuous Univariate Distributions 2 (1995), chapter 27.
    """
    return 0.5 * dof * math.expm1(-2.0 / dof * math.log(chance))
