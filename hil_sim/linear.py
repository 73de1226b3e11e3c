"""The linear equations of a held posture while effects add their terms to them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.assembly import Spring
from armodal.hil_sim.elements import Element
from armodal.hil_sim.newton_euler import Chain, Placement, point_jacobian
from armodal.protocols.errors import PlantError

__all__ = ["LinearTerms", "MaxwellElement"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class MaxwellElement:
    """A spring and a dashpot in series, pulling along `row` of the coordinates.

    With s = row @ q and z the dashpot's stretch: force k (s - z), z' = rate (s - z).
    """

    row: Array  # (n,)
    k: float
    rate_rad_s: float


@dataclass(slots=True, kw_only=True)
class LinearTerms:
    """M q'' + C q' + K q + Maxwell elements, coordinate by coordinate.

    The first coordinates are the hinges that give way, the others belong to effects.
    """

    chain: Chain
    at: Placement
    labels: tuple[str, ...]  # of the coordinates
    hinges: tuple[int, ...]  # of the coordinates that are hinges
    bodies: dict[str, int]  # hinge name -> body
    carrier: dict[str, str]  # link -> hinge name of its far end
    springs: dict[str, Spring]  # of the joints that give way
    stretch: dict[str, Array]  # joint -> (n,) row of what its spring is stretched by
    M: Array
    C: Array
    K: Array
    maxwell: list[MaxwellElement] = field(default_factory=list)
    elements: list[Element] = field(default_factory=list)
    load: dict[str, float] = field(default_factory=dict)  # joint -> gravity torque at rest, N m

    def index(self, label: str) -> int:
        """Row of a coordinate.

        Raises
        ------
        PlantError
            If nothing of that name gives way.
        """
        if label not in self.labels:
            raise PlantError(
                f"effects: {label!r} does not give way, so nothing can act on it; wanted one of "
                f"{', '.join(self.labels)}; give the joint a stiffness in the plant file"
            )
        return self.labels.index(label)

    def row(self, label: str) -> Array:
        """(n,) unit row of a coordinate."""
        row: Array = np.eye(len(self.labels))[self.index(label)]
        return row

    def stretch_of(self, joint: str) -> Array:
        """(n,) row of the coordinates by which a joint's spring is stretched."""
        self.index(joint)
        return self.stretch[joint]

    def spin_before(self, joint: str) -> Array:
        """(n,) spin, along a joint's axis, of the link that carries it."""
        body = self.bodies[joint]
        row = np.zeros((1, self.chain.n))
        turns = self.at.turns[:body, 0]
        row[0, :body] = turns * (self.at.axis[:body] @ self.at.axis[body])
        result: Array = self.full(row)[0]
        return result

    def full(self, of_hinges: Array) -> Array:
        """Columns (m, n) of all coordinates from (m, n_bodies) of all hinges of the chain."""
        result = np.zeros((len(of_hinges), len(self.labels)))
        result[:, : len(self.hinges)] = of_hinges[:, list(self.hinges)]
        return result

    def motion_of(self, link: str, position_m: Array) -> Array:
        """(6, n) velocity and spin of a point on a link, base axes, per coordinate."""
        if link not in self.carrier:
            raise PlantError(
                f"effects: no moving link is called {link!r}; wanted one of "
                f"{', '.join(self.carrier)}; correct the plant file"
            )
        body = self.bodies[self.carrier[link]]
        point = self.at.origin_m[body] + self.at.R[body] @ position_m
        return self.full(point_jacobian(self.at, body, point))

    def end_of(self, link: str, position_m: Array) -> tuple[Array, Array]:
        """Place (3,) and velocity (3, n) of a point on a link, or on the "floor", base axes."""
        if link == "floor" or (link == "base" and "base" not in self.carrier):
            return position_m, np.zeros((3, len(self.labels)))
        v = self.motion_of(link, position_m)[:3]
        body = self.bodies[self.carrier[link]]
        return self.at.origin_m[body] + self.at.R[body] @ position_m, v

    def spring(self, rows: Array, k: float, c: float) -> None:
        """Add a spring and a damper that resist each of `rows` (m, n) of motion."""
        self.K = self.K + k * rows.T @ rows
        self.C = self.C + c * rows.T @ rows
