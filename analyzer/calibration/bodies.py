"""Links whose mass distribution is only believed: a box, and how far the truth may lie from it.

A body is written as its mass m, its centre c and the spread of its mass S = E[(x-c)(x-c)ᵀ], a
positive definite matrix whose square roots are radii of gyration about planes. It is moved from
the belief by ten numbers that are independent standard normals a priori:

    m = m0 exp(s_m u_m),   c = c0 + s_c u_c,   S = S0^(1/2) exp(s_S X(u_S)) S0^(1/2)

with X symmetric. Every value of u is a body that can exist (the pseudo-inertia is positive
definite), so nothing has to be forbidden while fitting.

References
----------
Pseudo-inertia: P. M. Wensing, S. Kim, J.-J. Slotine, IEEE Robot. Autom. Lett. 3 (2018) 60.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.linalg

from armodal.protocols.arm.records import InertialLink

__all__ = ["N_NUMBERS", "BelievedBody", "moved_body"]

Array = npt.NDArray[np.float64]

N_NUMBERS = 10
_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass(frozen=True, slots=True, kw_only=True)
class BelievedBody:
    """A link as believed: its share of the mass, and the box it fills."""

    name: str
    mass_kg: float
    center_m: Array  # (3,), link frame
    box_m: Array  # (3,) side lengths along the link frame's axes
    mass_std: float  # relative
    center_std: float  # relative to each side of the box
    spread_std: float  # of the logarithm of S: radii of gyration by half of it

    @property
    def spread_m2(self) -> Array:
        """S of a full box: side² / 12 each way."""
        return np.diag(self.box_m**2 / 12.0)


def moved_body(body: BelievedBody, u: Array) -> InertialLink:
    """The link at ten standard normal numbers from the belief.

    Parameters
    ----------
    u
        (10,): mass, centre x y z, then xx, yy, zz, xy, xz, yz of the logarithm of S.
    """
    mass = body.mass_kg * float(np.exp(body.mass_std * u[0]))
    center = body.center_m + body.center_std * body.box_m * u[1:4]
    X = np.zeros((3, 3))
    for value, (i, j) in zip(u[4:], _PAIRS, strict=True):
        X[i, j] = X[j, i] = body.spread_std * value * (1.0 if i == j else np.sqrt(0.5))
    root = np.sqrt(body.spread_m2)
    S = root @ np.asarray(scipy.linalg.expm(X)) @ root
    inertia = mass * (np.trace(S) * np.eye(3) - S)
    return InertialLink(name=body.name, mass_kg=mass, center_m=center, inertia_kg_m2=inertia)
