"""How far apart the pieces of a link may lie: what they keep has to be a body's."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.linalg

from armodal.protocols.arm.records import InertialLink

__all__ = ["nearer"]

Array = npt.NDArray[np.float64]

_LEFT = 1e-3  # of the link's second moment, that pieces keep along their line at least
_NONE = 1e-12  # of the largest


def nearer(link: InertialLink, shares: Array, offsets_m: Array) -> float:
    """The largest part, at most 1, of the offsets that the link's own inertia allows.

    Pieces whose centres are apart take their spread from the link's tensor and share the rest. The
    second moment S = tr(J) / 2 - J of every body is positive semidefinite (R. Featherstone, Rigid
    Body Dynamics Algorithms (2008), section 2.13), and so has to be what is left of the link's.

    Parameters
    ----------
    shares : (P,)
        Parts of the mass.
    offsets_m : (P, 3)
        Of each piece's centre from the link's; their mean by mass is zero.
    """
    J = 0.5 * (link.inertia_kg_m2 + link.inertia_kg_m2.T)
    own = 0.5 * np.trace(J) * np.eye(3) - J
    size = float(np.abs(own).max())
    spread = link.mass_kg * np.einsum("p,pi,pj->ij", shares, offsets_m, offsets_m)
    if size <= 0.0 or not spread.any():
        return 1.0
    most = scipy.linalg.eigvalsh(spread, own + _NONE * size * np.eye(3))[-1]
    return float(min(1.0, np.sqrt((1.0 - _LEFT) / max(most, 1e-300))))
