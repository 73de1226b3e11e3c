"""Matrices of a straight beam with shear, in space: Timoshenko's beam of two nodes.

Przemieniecki, Theory of Matrix Structural Analysis, sections 5.6 and 11.5. The mass, with rotary
inertia, is that of the beam without shear. A node has three displacements and three rotations.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from armodal.hil_sim.makers.arm_table import Array, Triple

__all__ = ["Section", "beam_mass", "beam_stiffness", "flattened", "tube"]

POISSON = 0.33  # of aluminium


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A section with its second moments about both principal axes."""

    area_m2: float
    second_moments_m4: tuple[float, float]  # of bending about each
    torsion_m4: float
    shear_area_m2: float
    youngs_pa: float
    density_kg_m3: float
    width: Triple = (0.0, 0.0, 0.0)  # near the first axis, where both are not alike

    @property
    def mean_moment_m4(self) -> float:
        """Second moment of a round section that bends as far, on the mean of both axes."""
        first, second = self.second_moments_m4
        return 2.0 * first * second / (first + second)

    @property
    def shear_pa(self) -> float:
        """Shear modulus."""
        return self.youngs_pa / (2.0 * (1.0 + POISSON))


def tube(diameter_m: float, wall_m: float, youngs_pa: float, density_kg_m3: float) -> Section:
    """Section of a round tube; half of a thin tube's area carries its shear."""
    outer, inner = 0.5 * diameter_m, 0.5 * diameter_m - wall_m
    area = np.pi * (outer**2 - inner**2)
    second = 0.25 * np.pi * (outer**4 - inner**4)
    return Section(
        area_m2=area,
        second_moments_m4=(second, second),
        torsion_m4=2.0 * second,
        shear_area_m2=0.5 * area,
        youngs_pa=youngs_pa,
        density_kg_m3=density_kg_m3,
    )


def flattened(section: Section, height_over_width: float, width: Triple) -> Section:
    """A thin tube's section as that of a thin box of the same area and mean bending.

    `width` is the direction along which it is wide, as far as that is across the beam.

    A box of sides w and h and walls t has I = t h^2 (3 w + h) / 6 about the axis along w (Roark,
    Formulas for Stress and Strain, thin-walled rectangles).
    """
    h = height_over_width
    pair = np.array([h**2 * (3.0 + h), 1.0 + 3.0 * h])
    pair *= section.mean_moment_m4 * np.mean(1.0 / pair)
    return replace(section, second_moments_m4=(float(pair[0]), float(pair[1])), width=width)


def beam_stiffness(section: Section, start: Array, end: Array) -> Array:
    """Stiffness, (12, 12), between two nodes, world axes."""
    L = float(np.linalg.norm(end - start))
    E, G = section.youngs_pa, section.shear_pa
    planes = []
    for inertia in section.second_moments_m4:
        phi = 12.0 * E * inertia / (G * section.shear_area_m2 * L**2)
        a = 12.0 * E * inertia / (L**3 * (1.0 + phi))
        b = 6.0 * E * inertia / (L**2 * (1.0 + phi))
        c = (4.0 + phi) * E * inertia / (L * (1.0 + phi))
        d = (2.0 - phi) * E * inertia / (L * (1.0 + phi))
        planes.append(np.array([[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]]))
    stretch, twist = E * section.area_m2 / L, G * section.torsion_m4 / L
    return _turned(planes, stretch, twist, _PULL, section, start, end)


def beam_mass(section: Section, start: Array, end: Array) -> Array:
    """Consistent mass, (12, 12), between two nodes, world axes."""
    L = float(np.linalg.norm(end - start))
    m = section.density_kg_m3 * section.area_m2 * L
    bending = (m / 420.0) * np.array(
        [
            [156.0, 22.0 * L, 54.0, -13.0 * L],
            [22.0 * L, 4.0 * L**2, 13.0 * L, -3.0 * L**2],
            [54.0, 13.0 * L, 156.0, -22.0 * L],
            [-13.0 * L, -3.0 * L**2, -22.0 * L, 4.0 * L**2],
        ]
    )
    rotary = np.array(
        [
            [36.0, 3.0 * L, -36.0, 3.0 * L],
            [3.0 * L, 4.0 * L**2, -3.0 * L, -(L**2)],
            [-36.0, -3.0 * L, 36.0, -3.0 * L],
            [3.0 * L, -(L**2), -3.0 * L, 4.0 * L**2],
        ]
    )
    planes = [
        bending + m * inertia / section.area_m2 / (30.0 * L**2) * rotary
        for inertia in section.second_moments_m4
    ]
    turning = m * section.torsion_m4 / section.area_m2
    return _turned(planes, m / 6.0, turning / 6.0, _SHARE, section, start, end)


_PULL = np.array([[1.0, -1.0], [-1.0, 1.0]])
_SHARE = np.array([[2.0, 1.0], [1.0, 2.0]])


def _turned(
    planes: list[Array],
    along: float,
    about: float,
    pair: Array,
    section: Section,
    start: Array,
    end: Array,
) -> Array:
    """Put bending in two planes, tension and torsion together, and turn them into world axes.

    The first plane is that of bending about the section's first axis.
    """
    local = np.zeros((12, 12))
    mirrored = np.diag([1.0, -1.0, 1.0, -1.0])  # a turn about y lowers z
    local[np.ix_([0, 6], [0, 6])] = along * pair
    local[np.ix_([3, 9], [3, 9])] = about * pair
    local[np.ix_([1, 5, 7, 11], [1, 5, 7, 11])] = planes[1]
    local[np.ix_([2, 4, 8, 10], [2, 4, 8, 10])] = mirrored @ planes[0] @ mirrored
    x = (end - start) / np.linalg.norm(end - start)
    wide = np.array(section.width if any(section.width) else np.eye(3)[np.argmin(np.abs(x))])
    y = wide - (wide @ x) * x
    y /= np.linalg.norm(y)
    R = np.kron(np.eye(4), np.array([x, y, np.cross(x, y)]))
    turned: Array = R.T @ local @ R
    return turned
