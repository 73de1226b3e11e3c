"""Losses as causal laws: alike at every frequency, growing with a power of it, or relaxing."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.protocols.arm.reference import STIFFNESS_AT_HZ

__all__ = [
    "REFERENCE_RAD_S",
    "hysteresis",
    "lost_by_power",
    "lost_by_power_slope",
    "lost_by_power_slope_of_line",
    "relaxed",
    "relaxed_slope",
    "relaxed_slope_of_line",
]

# Where a joint with a loss factor has its stiffness k.
REFERENCE_RAD_S = 2.0 * np.pi * STIFFNESS_AT_HZ

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_LEAST_POWER = 1e-4  # less is as none, and loses digits


def hysteresis(s: ComplexArray) -> ComplexArray:
    """Return what a unit loss factor adds to a unit stiffness at s, in rad/s.

    ln s has the imaginary part pi / 2 at every frequency: `docs/decisions/0007-loss-is-causal.md`.
    """
    return np.asarray((2.0 / np.pi) * np.log(s / REFERENCE_RAD_S))


def lost_by_power(s: ComplexArray, power: Array) -> ComplexArray:
    """Return what a unit loss factor adds to a unit stiffness at s, in rad/s, if it grows.

    A spring-pot (Bagley and Torvik, AIAA J. 21 (1983) 741), less what it adds to the stiffness at
    `REFERENCE_RAD_S`, where its loss is one: with a = pi power / 2,

        h(s) = ((s / w)^power - cos a) / sin a ,

    which is `hysteresis` where the power is 0 and the damper s / w where it is 1.

    Parameters
    ----------
    s : (P, L)
    power : (P,) of frequency, 0 to 1
    """
    p = _power(power)
    a = 0.5 * np.pi * p
    # (x^p - 1) + (1 - cos a): neither loses digits where the power is small.
    grown = np.expm1(p * _ln(s)) + 2.0 * np.sin(0.5 * a) ** 2
    return np.asarray(grown / np.sin(a))


def lost_by_power_slope(s: ComplexArray, power: Array) -> ComplexArray:
    """Return the derivative of `lost_by_power` by the power, (P, L)."""
    p = _power(power)
    a = 0.5 * np.pi * p
    x = _ln(s)
    by_power = x * np.exp(p * x) + 0.5 * np.pi * np.sin(a)
    h = lost_by_power(s, power)
    return np.asarray((by_power - 0.5 * np.pi * np.cos(a) * h) / np.sin(a))


def lost_by_power_slope_of_line(s: ComplexArray, power: Array) -> ComplexArray:
    """Return the derivative of `lost_by_power` by the line s, (P, L)."""
    p = _power(power)
    return np.asarray(p * np.exp(p * _ln(s)) / (s * np.sin(0.5 * np.pi * p)))


def relaxed(s: ComplexArray, rate_rad_s: Array) -> ComplexArray:
    """Return what a part that relaxes adds to a unit stiffness at s, in rad/s, a unit of its loss.

    A spring and a damper in a row beside the stiffness (the standard linear solid: Lakes,
    Viscoelastic Materials (2009), section 2.6), less what they add to the stiffness at
    `REFERENCE_RAD_S`. It loses most, one, at its rate w, and adds two in all:

        z(s) = 2 s / (s + w) - 2 w0^2 / (w0^2 + w^2) .

    Parameters
    ----------
    s : (P, L)
    rate_rad_s : (P,)
    """
    w = rate_rad_s.astype(float)[..., None]
    there = REFERENCE_RAD_S**2 / (REFERENCE_RAD_S**2 + w**2)
    return np.asarray(2.0 * s / (s + w) - 2.0 * there)


def relaxed_slope(s: ComplexArray, rate_rad_s: Array) -> ComplexArray:
    """Return the derivative of `relaxed` by the logarithm of its rate, (P, L)."""
    w = rate_rad_s.astype(float)[..., None]
    there = REFERENCE_RAD_S * w / (REFERENCE_RAD_S**2 + w**2)
    return np.asarray(4.0 * there**2 - 2.0 * s * w / (s + w) ** 2)


def relaxed_slope_of_line(s: ComplexArray, rate_rad_s: Array) -> ComplexArray:
    """Return the derivative of `relaxed` by the line s, (P, L)."""
    w = rate_rad_s.astype(float)[..., None]
    return np.asarray(2.0 * w / (s + w) ** 2)


def _power(power: Array) -> Array:
    return np.asarray(np.maximum(power.astype(float), _LEAST_POWER)[..., None])


def _ln(s: ComplexArray) -> ComplexArray:
    return np.asarray(np.log(s.astype(np.complex128) / REFERENCE_RAD_S))
