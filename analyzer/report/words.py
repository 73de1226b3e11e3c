"""Numbers as the report writes them."""

from __future__ import annotations

import math

__all__ = ["plus_minus", "rounded", "share", "spaced"]

_THIN = "\u202f"  # narrow no-break space between thousands


def spaced(value: float, decimals: int = 0) -> str:
    """A number with its thousands apart.

    Examples
    --------
    >>> spaced(89600.4).replace("\u202f", " ")
    '89 600'
    """
    return f"{value:,.{decimals}f}".replace(",", _THIN)


def plus_minus(value: float, std: float) -> tuple[str, str]:
    """Value and standard deviation, both to the second digit of the standard deviation.

    Examples
    --------
    >>> [text.replace("\u202f", " ") for text in plus_minus(89342.0, 1843.0)]
    ['89 300', '1 800']
    >>> plus_minus(15.1379, 0.0809)
    ('15.138', '0.081')
    """
    if not (math.isfinite(std) and std > 0.0):
        return rounded(value), "not known"
    decimals = 1 - math.floor(math.log10(float(f"{std:.1e}")))
    return (
        spaced(round(value, decimals), max(decimals, 0)),
        spaced(round(std, decimals), max(decimals, 0)),
    )


def rounded(value: float, digits: int = 3) -> str:
    """A number to so many digits, without an exponent where it is an ordinary one.

    Examples
    --------
    >>> rounded(86432.0).replace("\u202f", " ")
    '86 400'
    >>> rounded(2.1e-5)
    '2.1e-05'
    """
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    power = math.floor(math.log10(abs(value)))
    if not -4 <= power < 7:
        return f"{value:.{digits}g}"
    decimals = digits - 1 - power
    return spaced(round(value, decimals), max(decimals, 0))


def share(relative: float) -> str:
    """A relative difference in per cent, to two digits and never as a bare zero.

    Examples
    --------
    >>> share(0.0034), share(0.2096), share(0.00001)
    ('0.34 %', '21 %', 'less than 0.01 %')
    """
    percent = 100.0 * abs(relative)
    if percent < 0.01:
        return "less than 0.01 %"
    return f"{percent:.2g} %" if percent < 99.5 else f"{percent:.0f} %"
