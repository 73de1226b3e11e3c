"""A quantity that every group shows with its own scatter, and that may differ between them.

x_g = x + u_g + e_g: the variance of e_g is known, that of u is found from how much more the values
scatter than that (DerSimonian and Laird, Control. Clin. Trials 7 (1986) 177). Whether u is there at
all is Cochran's question (Biometrics 10 (1954) 101): Q = sum_g (x_g - x)^2 / var e_g is chi-square
with one degree of freedom less than groups where only scatter moves them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

__all__ = ["Quantity", "random_effects"]

_Real = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """A quantity over groups."""

    mean: float
    std: float  # of the mean, over what other groups could have been
    spread: float  # standard deviation over the groups beside their scatter
    value: _Real  # (n_groups,) as each group sees it
    value_std: _Real  # (n_groups,) infinite where it is not seen
    drawn: _Real  # (n_groups,) drawn towards the mean by what a group cannot see
    chance: float  # that scatter alone sets the values so far apart


def random_effects(x: _Real, std: _Real) -> Quantity:
    """Mean of values (n_groups,) with standard deviations; infinite where one is not seen."""
    seen = np.isfinite(std)
    n = int(seen.sum())
    variance = np.where(seen, std, 1.0) ** 2
    w = np.where(seen, 1.0 / variance, 0.0)
    if n < 2:
        mean = float(x[seen][0]) if n else float(np.mean(x))
        q, spread2 = 0.0, 0.0
    else:
        mean = float(w @ x / w.sum())
        q = float(w @ (x - mean) ** 2)
        spread2 = max(0.0, (q - (n - 1)) / float(w.sum() - (w @ w) / w.sum()))
        w = np.where(seen, 1.0 / (variance + spread2), 0.0)
        mean = float(w @ x / w.sum())
    share = np.where(seen, spread2 / (spread2 + variance), 0.0)
    return Quantity(
        mean=mean,
        std=float(1.0 / np.sqrt(w.sum())) if n else np.inf,
        spread=float(np.sqrt(spread2)),
        value=x,
        value_std=std,
        drawn=mean + share * (x - mean),
        chance=float(scipy.special.chdtrc(max(n - 1, 1), q)),
    )
