"""Where the pieces of a link lie: what they keep has to be a body's."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.records import InertialLink

__all__ = ["apart", "second_moment"]

Array = npt.NDArray[np.float64]

_LEFT = 1e-3  # of the link's second moment, that pieces keep along their line at least


def second_moment(link: InertialLink) -> Array:
    """Return S (3, 3) about the centre, the integral of r r' dm: tr(J) / 2 - J."""
    J = 0.5 * (link.inertia_kg_m2 + link.inertia_kg_m2.T)
    return np.asarray(0.5 * np.trace(J) * np.eye(3) - J)


def apart(link: InertialLink, along: Array, shares: Array, places_m: Array) -> Array:
    """Return offsets (P, 3) of the pieces' centres from the link's.

    A link cut across a direction a has the centre of what lies at x along it at S a x / (a' S a),
    as every body has whose mass is spread like an ellipsoid's: a slender one's pieces lie along
    its own line, whichever way the next joint is. Pieces whose centres are apart take their spread
    from the link's tensor and share the rest. The second moment S of every body is positive
    semidefinite (R. Featherstone, Rigid Body Dynamics Algorithms (2008), section 2.13), and so has
    to be what is left of the link's: farther than that allows they are not.

    Parameters
    ----------
    along : (3,)
        Unit direction a, in the link's frame.
    shares : (P,)
        Parts of the mass.
    places_m : (P,)
        Of each piece along it from the link's centre; their mean by mass is zero.
    """
    to = second_moment(link) @ along
    own = float(along @ to)
    taken = link.mass_kg * float(shares @ places_m**2)
    if own <= 0.0 or taken <= 0.0:
        return np.outer(places_m, along)
    return np.outer(places_m * min(1.0, np.sqrt((1.0 - _LEFT) * own / taken)), to / own)
