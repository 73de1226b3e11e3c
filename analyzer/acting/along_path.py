"""The free motion chosen for a whole path: stiff on the mean, and no joint faster than it may be.

Of p poses with m samples of the free motion each, the chain of samples with the least sum of
compliances whose joints turn no further from pose to pose than allowed is found by dynamic
programming (R. Bellman, Dynamic Programming (1957), chapter III).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["best_along_path"]

Array = npt.NDArray[np.float64]

_STRAY = 1e-6  # of a compliance, that the way from the given posture costs: of equals the nearest


def best_along_path(
    joints_rad: Array, along_n_per_m: Array, angle_rad: Array, step_rad: float, limit_rad: Array
) -> npt.NDArray[np.intp]:
    """Return the sample of every pose.

    Parameters
    ----------
    joints_rad : (p, m, n_joints)
        NaN where there is no posture. The given ones follow one another within the limits.
    along_n_per_m : (p, m)
    angle_rad : (m,)
        Way of all joints together from the given posture, zero there.
    step_rad
        From sample to sample, all joints together.
    limit_rad : (p - 1,)
        That any joint may turn by from one pose to the next.
    """
    p, m, n = joints_rad.shape
    compliance = np.where(np.isnan(along_n_per_m), np.inf, 1.0 / along_n_per_m)
    compliance = compliance * (1.0 + _STRAY * np.abs(angle_rad))
    came = np.zeros((p, m), dtype=np.intp)
    total = compliance[0]
    for pose in range(1, p):
        limit = float(limit_rad[pose - 1])
        # As many samples as the limit spans where all joints turn alike, and one for the given.
        reach = min(m - 1, int(np.ceil(limit * np.sqrt(n) / step_rad)) + 1)
        least, source = np.full(m, np.inf), np.zeros(m, dtype=np.intp)
        for shift in range(-reach, reach + 1):
            here = np.arange(max(0, -shift), min(m, m - shift))
            there = here + shift
            turned = np.abs(joints_rad[pose, here] - joints_rad[pose - 1, there]).max(axis=1)
            own = np.where(turned <= limit, total[there], np.inf)
            better = own < least[here]
            least[here[better]], source[here[better]] = own[better], there[better]
        total, came[pose] = least + compliance[pose], source
    chosen = np.zeros(p, dtype=np.intp)
    chosen[-1] = int(np.argmin(total))
    for pose in range(p - 1, 0, -1):
        chosen[pose - 1] = came[pose, chosen[pose]]
    return chosen
