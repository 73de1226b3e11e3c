"""The chain while it is put together: segments with names, cut and loaded by effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.newton_euler import Body, skew
from armodal.protocols.errors import PlantError

__all__ = ["Assembly", "Inertial", "Segment", "Spring"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Spring:
    """Stiffness and viscous damping of a hinge, per rad (per m where it slides)."""

    k: float
    c: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Inertial:
    """Mass, its centre and the inertia about the centre."""

    mass_kg: float = 0.0
    center_m: Array = field(default_factory=lambda: np.zeros(3))
    inertia_kg_m2: Array = field(default_factory=lambda: np.zeros((3, 3)))

    def joined(self, other: Inertial) -> Inertial:
        """Both as one body, by the parallel axes theorem."""
        total = self.mass_kg + other.mass_kg
        if total == 0.0:
            return self
        center = (self.mass_kg * self.center_m + other.mass_kg * other.center_m) / total
        inertia = np.zeros((3, 3))
        for part in (self, other):
            S = skew(part.center_m - center)
            inertia += part.inertia_kg_m2 - part.mass_kg * S @ S
        return Inertial(mass_kg=total, center_m=center, inertia_kg_m2=inertia)

    def share(self, part: float) -> Inertial:
        """The same body with a part of its mass."""
        return Inertial(
            mass_kg=part * self.mass_kg,
            center_m=self.center_m,
            inertia_kg_m2=part * self.inertia_kg_m2,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """A body behind its hinge; without a spring the hinge is rigid while held."""

    label: str
    body: Body
    spring: Spring | None
    is_joint: bool = False

    def inertial(self) -> Inertial:
        """Mass of the body."""
        body = self.body
        return Inertial(
            mass_kg=body.mass_kg, center_m=body.center_m, inertia_kg_m2=body.inertia_kg_m2
        )

    def loaded(self, inertial: Inertial) -> Segment:
        """The same with another mass."""
        body = replace(
            self.body,
            mass_kg=inertial.mass_kg,
            center_m=inertial.center_m,
            inertia_kg_m2=inertial.inertia_kg_m2,
        )
        return replace(self, body=body)


@dataclass(frozen=True, slots=True, kw_only=True)
class Assembly:
    """Segments from the base outwards, and which of them carries each link and each point.

    A joint's segment is called as the joint. `carrier` holds, for each link and for "base" where
    it moves, the segment of its far end; `perch` the points that stand on an earlier one.
    """

    segments: tuple[Segment, ...]
    carrier: Mapping[str, str]
    points: Mapping[str, tuple[str, Array]]  # link and place in its frame, m
    perch: Mapping[str, str] = field(default_factory=dict)

    def index(self, label: str) -> int:
        """Place of a segment in the chain."""
        for i, segment in enumerate(self.segments):
            if segment.label == label:
                return i
        known = ", ".join(segment.label for segment in self.segments)
        raise PlantError(
            f"effects: no hinge or joint is called {label!r}; wanted one of {known}; correct the "
            "plant file"
        )

    def segment(self, label: str) -> Segment:
        """Return a segment by name."""
        return self.segments[self.index(label)]

    def joint(self, name: str) -> Segment:
        """Return a joint's segment."""
        segment = self.segment(name)
        if not segment.is_joint:
            raise PlantError(f"effects: {name!r} is no joint; correct the plant file")
        return segment

    def carrier_of(self, link: str) -> Segment:
        """Return the segment of a link's far end."""
        if link not in self.carrier:
            raise PlantError(
                f"effects: no moving link is called {link!r}; wanted one of "
                f"{', '.join(self.carrier)}; correct the plant file"
            )
        return self.segment(self.carrier[link])

    def replaced(self, segment: Segment) -> Assembly:
        """The same with another segment of that name."""
        i = self.index(segment.label)
        return replace(self, segments=(*self.segments[:i], segment, *self.segments[i + 1 :]))

    def split(
        self,
        at: str,
        label: str,
        *,
        hinge_m: Array,
        axis: Array,
        spring: Spring,
        before: Inertial | None = None,
        after: Inertial | None = None,
        points_before: tuple[str, ...] = (),
    ) -> Assembly:
        """Cut segment `at` by a hinge through `hinge_m` along `axis`, both in its frame.

        What the segment carried stands beyond the cut, but for `before` (nothing, unless given)
        and the points named.
        """
        i = self.index(at)
        if any(segment.label == label for segment in self.segments):
            raise PlantError(
                f"effects: two hinges would be called {label!r}; name each effect of a kind once "
                "for a place, or give it a name of its own"
            )
        near = self.segments[i]
        body = Body(
            name=label,
            origin_m=np.zeros(3),
            R_parent_body=np.eye(3),
            hinge_m=hinge_m,
            axis=axis / np.linalg.norm(axis),
            mass_kg=0.0,
            center_m=np.zeros(3),
            inertia_kg_m2=np.zeros((3, 3)),
        )
        far = Segment(label=label, body=body, spring=spring)
        far = far.loaded(after or near.inertial())
        near = near.loaded(before or Inertial())
        perch = {point: label if on == at else on for point, on in self.perch.items()}
        perch |= dict.fromkeys(points_before, at)
        return replace(
            self,
            segments=(*self.segments[:i], near, far, *self.segments[i + 1 :]),
            carrier={link: label if on == at else on for link, on in self.carrier.items()},
            perch=perch,
        )
