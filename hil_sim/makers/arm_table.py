"""Arms of the makers as tables: chain, inertials, shells, drives and postures."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

__all__ = ["ArmTable", "Array", "Inertial", "LinkRow", "Shell", "box", "rotation"]

Array = npt.NDArray[np.float64]
ALIGNED = 0.7  # cosine between a link's line and a joint's axis
Triple = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Inertial:
    """Mass, centre and inertia about it, in the link's frame."""

    mass_kg: float
    center_m: Triple
    inertia_kg_m2: tuple[float, float, float, float, float, float]  # xx yy zz xy xz yz

    def matrix(self) -> Array:
        """Return the inertia about the centre, (3, 3), link axes."""
        xx, yy, zz, xy, xz, yz = self.inertia_kg_m2
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def with_body(self, other: Inertial) -> Inertial:
        """Return both bodies as one."""
        mass = self.mass_kg + other.mass_kg
        center = np.zeros(3)
        for body in (self, other):
            center += body.mass_kg / mass * np.array(body.center_m)
        whole = np.zeros((3, 3))
        for body in (self, other):
            r = np.array(body.center_m) - center
            whole += body.matrix() + body.mass_kg * (r @ r * np.eye(3) - np.outer(r, r))
        return Inertial.of(mass, center, whole)

    @staticmethod
    def of(mass_kg: float, center: Array, inertia: Array) -> Inertial:
        """Return the record of arrays (3,) and (3, 3)."""
        pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
        xx, yy, zz, xy, xz, yz = (float(inertia[i, j]) for i, j in pairs)
        x, y, z = (float(value) for value in center)
        return Inertial(
            mass_kg=float(mass_kg), center_m=(x, y, z), inertia_kg_m2=(xx, yy, zz, xy, xz, yz)
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Shell:
    """A tube round a line of points, link frame; sensors sit on it."""

    path: tuple[Triple, ...]
    diameter_m: float
    wall_m: float

    @property
    def slenderness(self) -> float:
        """Length of the longest straight piece over the diameter."""
        return float(np.linalg.norm(self.longest_m)) / self.diameter_m

    @property
    def longest_m(self) -> Array:
        """The longest straight piece, (3,) link frame."""
        pieces = np.diff(np.array(self.path), axis=0)
        return np.asarray(pieces[np.argmax(np.linalg.norm(pieces, axis=1))])


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkRow:
    """A joint that turns about its frame's z axis, and the link it moves."""

    joint: str
    link: str
    xyz_m: Triple  # of the joint frame in the parent link's
    rpy_rad: Triple
    range_deg: tuple[float, float]
    stiffness_n_m_per_rad: float  # of the drive, as a data sheet of its size has it
    inertial: Inertial
    shell: Shell


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmTable:
    """An arm of public figures."""

    name: str
    source: str
    base: Inertial
    base_shell: Shell
    links: tuple[LinkRow, ...]
    tool: Inertial  # a block on the flange, there to be hit; frame of the last link
    wrist: tuple[str, ...]  # joints that the arm with a rigid wrist has locked
    postures_deg: tuple[tuple[float, ...], ...]
    youngs_modulus_pa: float  # of the shells
    density_kg_m3: float
    peaks_n: tuple[float, float, float]  # of soft, middle and hard hits

    @property
    def long_links(self) -> tuple[str, str]:
        """Return the two links that are beams most of all: the slender ones, from the base on."""
        first, second, *_ = np.argsort([-row.shell.slenderness for row in self.links])
        one, other = sorted((int(first), int(second)))
        return self.links[one].link, self.links[other].link

    @property
    def twisting_links(self) -> tuple[str, ...]:
        """Return the long links whose line is no joint's axis: others twist as that joint turns."""
        after = {row.link: next_row for row, next_row in pairwise(self.links)}
        found = []
        for row in self.links:
            line = row.shell.longest_m / np.linalg.norm(row.shell.longest_m)
            beyond = rotation(after[row.link].rpy_rad)[:, 2] if row.link in after else np.zeros(3)
            aligned = max(abs(line[2]), abs(line @ beyond))
            if row.link in self.long_links and aligned < ALIGNED:
                found.append(row.link)
        return tuple(found)

    def inertials(self) -> tuple[Inertial, ...]:
        """Return every link's inertial, the tool on the last."""
        bodies = [row.inertial for row in self.links]
        return (*bodies[:-1], bodies[-1].with_body(self.tool))


def box(mass_kg: float, center_m: Triple, sides_m: Triple) -> Inertial:
    """Inertial of a full box along the axes of its link."""
    a, b, c = (side * side / 12.0 * mass_kg for side in sides_m)
    return Inertial(
        mass_kg=mass_kg, center_m=center_m, inertia_kg_m2=(b + c, a + c, a + b, 0.0, 0.0, 0.0)
    )


def rotation(rpy_rad: Triple) -> Array:
    """Rotation about fixed x, then y, then z, (3, 3)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy_rad), np.sin(rpy_rad)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    about_y = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    about_z = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    turned: Array = about_z @ about_y @ about_x
    return turned
