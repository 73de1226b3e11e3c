"""Standard deviations with so many decimals, never as a nought that nobody measured."""

from __future__ import annotations

__all__ = ["deviation"]


def deviation(std: float, decimals: int = 3) -> str:
    """A standard deviation as tables show it.

    Examples
    --------
    >>> deviation(0.0321), deviation(0.00049)
    ('0.032', '< 0.0005')
    """
    text = f"{std:.{decimals}f}"
    half = 0.5 * 10.0**-decimals
    return f"< {half:.{decimals + 1}f}" if 0.0 <= std <= half else text
