"""Scales that controllers use: degrees, radians and parts of a turn, in round steps."""

from __future__ import annotations

import math

__all__ = ["likely_offset", "likely_scale"]

_ROUND = (1.0, 2.0, 2.5, 5.0)
_DEGREES = [part * 10.0**-k for k in range(9) for part in _ROUND] + [1.0 / 60.0, 1.0 / 3600.0]
_RADIANS = [math.degrees(10.0**-k) for k in range(9)]
_TURNS = [360.0 / 2**n for n in range(8, 33)]
LIKELY = tuple(sorted({*_DEGREES, *_RADIANS, *_TURNS}))


def likely_scale(factor_deg: float, relative_error: float) -> float | None:
    """Return the one usual scale within an error of a fitted one, its sign kept; else None.

    >>> likely_scale(-0.00010003, 1e-3)
    -0.0001
    >>> likely_scale(0.00011, 1e-3) is None
    True
    """
    near = [one for one in LIKELY if abs(abs(factor_deg) / one - 1.0) <= relative_error]
    return math.copysign(near[0], factor_deg) if len(near) == 1 else None


def likely_offset(offset_deg: float, allowed_deg: float) -> float:
    """Return a quarter turn's multiple within what is allowed, else the offset to 0.0001 degree.

    >>> likely_offset(-89.98, 0.05), likely_offset(12.34567, 0.05)
    (-90.0, 12.3457)
    """
    quarter = 90.0 * round(offset_deg / 90.0)
    return quarter if abs(offset_deg - quarter) <= allowed_deg else round(offset_deg, 4)
