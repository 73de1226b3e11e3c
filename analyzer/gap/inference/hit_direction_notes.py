"""Postures whose hits hardly move a mode: its response is then what their aim makes of it.

Each mounting's hits have an aim of their own, and three hits tell little of how they scatter. A
model that is right may then be far from such a posture at such a mode.
"""

from __future__ import annotations

import numpy as np

from armodal.analyzer.gap.inference.fit import Fit, Stage

__all__ = ["hit_direction_notes"]

# Of the response at a line, by an aim off by the arm's tolerance: postures of both arms' plans have
# 0.21 at most; one with 0.29 was said to have what the library does not know, and had nothing.
_MUCH = 0.25


def hit_direction_notes(stage: Stage, fit: Fit) -> list[str]:
    """Return a note for every posture where an ordinary error of the aim changes a line by much."""
    off_rad = fit.hypothesis.ordinary.arm.tolerances.hit_direction_rad
    off_deg = np.rad2deg(off_rad)
    found: dict[str, str] = {}
    for rows, postures in stage.once(fit.hypothesis, range(len(stage.lines))):
        y, dy = postures.derivatives(fit.hypothesis, fit.space, fit.values)
        for p, i in rows:
            lines = stage.lines[p]
            sides = [fit.space.index[f"aim {side} {lines.name}"] for side in "ab"]
            # An effect may have named its aim and widened the prior by which `dy` is.
            per_tolerance = off_rad / fit.space.std[sides, None, None, None]
            by_hit_direction = np.sum(np.abs(per_tolerance * dy[sides, i]) ** 2, axis=(0, 1, 2))
            part = np.sqrt(by_hit_direction / np.sum(np.abs(y[i]) ** 2, axis=(0, 1)))
            worst = int(np.argmax(part))
            if part[worst] > _MUCH:
                hz = lines.s_rad_s[worst].imag / (2.0 * np.pi)
                found[lines.name] = (
                    f"posture {lines.name!r}: hits hardly move what answers at {hz:.0f} Hz; an aim "
                    f"off by {off_deg:.1f} deg changes that by {part[worst]:.0%}, and what is left "
                    "there may be no more than that. Hit along another direction or on another "
                    "point"
                )
    return list(found.values())
