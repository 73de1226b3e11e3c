"""The mass of a link from its convex hull.

Links are not uniform: gears, motors and bearings sit in the short ones, long ones are tubes. Over
the moving links of 20 public arms that have meshes and inertials the density of a link's convex
hull falls with its slenderness,

    density = DENSITY · compactness ** SLENDER,

compactness the hull's volume over that of a ball with the same mean square about its centre. The
exponent holds from maker to maker: fitted to all makers but one it is 0.48 to 0.61, and tells the
links of the one left out to a factor of 1.37 (one standard deviation), against 1.65 with one
density (`bench/bench_own_arm.py --inertials`, docs/own-arm.md).
"""

from __future__ import annotations

import numpy as np

from armodal.analyzer.own_arm.surface import Surface

__all__ = [
    "DENSITY",
    "MASS_KNOWN_TOTAL",
    "MASS_LAST",
    "MASS_NO_TOTAL",
    "SLENDER",
    "compactness",
    "hull_mass",
]

DENSITY = 1750.0  # kg/m³ over the hull of a ball
SLENDER = 0.55
# One standard deviation of the logarithm over the links of 26 other arms of nine makers, with the
# arm's total known; without one over the first 20. The last link may be a bare flange.
MASS_KNOWN_TOTAL, MASS_NO_TOTAL, MASS_LAST = 0.35, 0.45, 0.60


def compactness(surface: Surface) -> float:
    """Volume of the hull over that of a ball of the same mean square; 1 for a ball."""
    filled = surface.hull_filling
    # A ball of radius R has the mean square 3 R²/5.
    radius = np.sqrt(5.0 / 3.0 * np.trace(filled.second_m2))
    return float(filled.volume_m3 / (4.0 / 3.0 * np.pi * radius**3))


def hull_mass(surface: Surface) -> float:
    """The mass that the law gives a link, kg."""
    return float(DENSITY * surface.hull_filling.volume_m3 * compactness(surface) ** SLENDER)
