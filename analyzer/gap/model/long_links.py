"""Links long enough to bend: each a line along which it gives way.

A slender casting's line is its axis of least inertia, through its centre: that of the tube, which
on an arm with offsets passes beside its joints. Of any other it is from its joint to the next. A
description may put a joint anywhere on its axis, and often where the axes of a wrist meet: a link
whose next joint stands at its own comes from the other side.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.assembly import Inside
from armodal.analyzer.gap.model.spread import apart
from armodal.analyzer.gap.model.stretch import Stretch
from armodal.protocols.arm.records import InertialLink

__all__ = ["SLICES", "LongLink", "long_links", "span_m"]

Array = npt.NDArray[np.float64]

_LEAST_M = 0.2  # shorter links are stiff
# Least over next moment of inertia of a rod 1.5 times as long as it is wide; and its line goes to
# the next joint rather than past it.
_SLENDER, _TOWARDS = 0.5, np.sqrt(0.5)
SLICES = 5  # hinges at 1/10, 3/10, ...: they give a tip wrench's deflection to 1 %


@dataclass(frozen=True, slots=True, kw_only=True)
class LongLink:
    """A link's line in the link's own frame, from its root to its tip."""

    link: int
    name: str
    along: Array  # (3,) unit
    length_m: float
    start_m: Array = field(default_factory=lambda: np.zeros(3))  # (3,) its root

    @property
    def places_m(self) -> tuple[float, ...]:
        """Return where along the line, from its root, the hinges stand."""
        return tuple((i + 0.5) / SLICES * self.length_m for i in range(SLICES))

    def pieces(self, link: InertialLink, spread: float) -> tuple[Array, Array]:
        """Shares (P,) of its mass in pieces between the hinges, and offsets (P, 3) of centres.

        Spread evenly over that part of its length about its centre, as far as its inertia allows.
        """
        edges = np.array([0.0, *self.places_m, self.length_m])
        shares = np.diff(edges) / self.length_m
        middles = 0.5 * (edges[1:] + edges[:-1]) - 0.5 * self.length_m
        return shares, apart(link, self.along, shares, spread * middles)

    def about(self, superset: Superset, place: float, by: str) -> Inside:
        """How a hinge for the stretch about a place moves the link's points and its mass.

        Parameters
        ----------
        place
            Part of the length. The stretch is as long as it can be with its middle there.
        by
            The parameter whose value that is.
        """
        start, end = max(2.0 * place - 1.0, 0.0), min(2.0 * place, 1.0)
        late = place > 0.5
        return self.inside(superset, (start, end), {by: (2.0 * late, 2.0 * (not late))})

    def inside(
        self,
        superset: Superset,
        ends: tuple[float, float],
        by: Mapping[str, tuple[float, float]] = MappingProxyType({}),
    ) -> Inside:
        """How a hinge that stands for an evenly soft stretch moves the link's points and its mass.

        Parameters
        ----------
        ends
            Of the stretch, parts of the length.
        by
            Parameters that move them, and by how much each a unit.
        """
        start_m, end_m = (end * self.length_m for end in ends)
        stretch = Stretch(
            along=self.along,
            length_m=self.length_m,
            start_m=start_m,
            end_m=end_m,
            start_slopes_m=tuple(start * self.length_m for start, _ in by.values()),
            end_slopes_m=tuple(end * self.length_m for _, end in by.values()),
        )
        points = [i for i, own in enumerate(superset.point_link) if own == self.link]
        placed = [superset.arm.points[i] for i in points]
        at_m = np.array([(p.position_m - self.start_m) @ self.along for p in placed])
        back = np.array([point.R_link_sensor.T @ self.along for point in placed])
        part, back_m, by_part, by_back_m = stretch.parts(at_m)
        return Inside(
            link=self.link,
            points=np.array(points, dtype=np.int64),
            part=part,
            shift_m=back_m[:, None] * back,
            stretch=stretch,
            by=tuple(by),
            part_slopes=by_part,
            shift_slopes_m=by_back_m[..., None] * back,
        )


def long_links(superset: Superset) -> tuple[LongLink, ...]:
    """Return the links long enough to bend, with points at two places at least."""
    found = []
    joints = superset.arm.joints
    for i, joint in enumerate(joints):
        if superset.point_link.count(i) < 2:
            continue
        root, tip = span_m(superset, i)
        reach = tip - root
        if np.linalg.norm(reach) < _LEAST_M:
            continue
        along, start = _line(joint.link, root, reach)
        length = float(along @ reach)
        found.append(
            LongLink(link=i, name=joint.link.name, along=along, length_m=length, start_m=start)
        )
    return tuple(found)


def _line(link: InertialLink, root: Array, reach: Array) -> tuple[Array, Array]:
    """Direction and start (3,) of the line of a link that reaches so far from its root."""
    towards = reach / np.linalg.norm(reach)
    moments, axes = np.linalg.eigh(np.asarray(link.inertia_kg_m2))
    along = axes[:, 0] * np.sign(axes[:, 0] @ towards)
    if moments[0] > _SLENDER * moments[1] or along @ towards < _TOWARDS:
        return towards, root
    center = np.asarray(link.center_m)
    return along, center - along * (along @ (center - root))


def span_m(superset: Superset, link: int) -> tuple[Array, Array]:
    """Return a link's root and tip, each (3,) in its frame: from its joint to the next.

    The last link goes to twice its centre; one whose next joint stands at its own comes from there.
    """
    joints = superset.arm.joints
    here, far = np.zeros(3), 2.0 * np.asarray(joints[link].link.center_m)
    if link + 1 == len(joints):
        return here, far
    beyond = np.asarray(joints[link + 1].T_parent_joint[:3, 3])
    return (here, beyond) if np.linalg.norm(beyond) >= _LEAST_M / 4.0 else (far, beyond)
