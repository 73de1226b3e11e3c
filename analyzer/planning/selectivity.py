"""How alone a joint moves in a posture: its coupling to the others in the mass matrix.

File 002, section 3: where the couplings M_ij of joint i are small against M_ii, one mode is
dominated by that joint, and its frequency gives the joint's stiffness (Eqs. 7, 10, 11).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["coupling_ratios", "separable_set", "worst_coupling"]

Array = npt.NDArray[np.float64]

SEPARATE = 0.1  # M_ij² / (M_ii M_jj) above this ties two joints together


def coupling_ratios(mass: Array) -> Array:
    """The papers' measure |M_ij| / M_ii, zero on the diagonal.

    Parameters
    ----------
    mass
        (n, n, n_postures), of the elastic joints only.

    Returns
    -------
    (n, n, n_postures) float64
        Row i is joint i's couplings over its own moment of inertia.
    """
    n = len(mass)
    ratios = np.abs(mass) / mass[np.arange(n), np.arange(n)][:, None]
    ratios[np.arange(n), np.arange(n)] = 0.0
    return ratios


def worst_coupling(mass: Array) -> Array:
    """Largest ratio of each joint to any other, (n, n_postures)."""
    return np.asarray(coupling_ratios(mass).max(axis=1))


def separable_set(mass: Array, joint: int) -> tuple[int, ...]:
    """The smallest set of joints with `joint` in it that nothing ties to the rest.

    Parameters
    ----------
    mass
        (n, n) in one posture, of the elastic joints.

    Notes
    -----
    Two joints are tied where M_ij² > 0.1 M_ii M_jj: the square of their coupling coefficient, by
    which one's frequency moves when the other is let loose.
    """
    diagonal = np.diag(mass)
    tied = mass**2 > SEPARATE * np.outer(diagonal, diagonal)
    reached = {joint}
    while True:
        more = {int(j) for i in reached for j in np.flatnonzero(tied[i])} | reached
        if more == reached:
            return tuple(sorted(reached))
        reached = more
