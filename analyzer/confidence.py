"""How many deviations of a Gaussian hold 95 %."""

from scipy.special import ndtri

__all__ = ["ONE_SIDED_95", "TWO_SIDED_95"]

TWO_SIDED_95, ONE_SIDED_95 = float(ndtri(0.975)), float(ndtri(0.95))
