"""What the identification lines of a universal file tell beside its fields.

armodal's own files tell in them what the format has no field for: directions along no axis, and
how FRFs were averaged. They stay readable words to everybody else.
"""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.measured import ToldDof, axis_direction
from armodal.protocols.foreign.uff_records import FunctionKind, UffFunction

__all__ = [
    "VARIANCE_WORDS",
    "direction_words",
    "estimate_words",
    "is_variance",
    "reference_dof",
    "response_dof",
    "told_estimate",
]

VARIANCE_WORDS = "armodal variance of this frequency response"
_DIRECTION = re.compile(r"armodal (response|reference) direction (\S+) (\S+) (\S+)")
_ESTIMATE = re.compile(r"armodal averages (\d{1,6}), window decay (\S{1,30}) rad/s")


def direction_words(what: str, direction: npt.NDArray[np.float64]) -> str:
    """Return the identification line that tells a direction along no axis.

    >>> direction_words("reference", np.array([0.6, 0.0, 0.8]))
    'armodal reference direction 0.600000000 0.000000000 0.800000000'
    """
    return f"armodal {what} direction " + " ".join(f"{x:.9f}" for x in direction)


def estimate_words(averages: int, decay_rad_s: float) -> str:
    """Return the identification line that tells averages and window.

    >>> estimate_words(3, 2.5)
    'armodal averages 3, window decay 2.5 rad/s'
    """
    return f"armodal averages {averages}, window decay {decay_rad_s:.12g} rad/s"


def is_variance(function: UffFunction) -> bool:
    """Return whether a function is the variance E|error|^2 of an FRF, as armodal writes it."""
    return function.kind == FunctionKind.GENERAL and function.identification[2] == VARIANCE_WORDS


def told_estimate(function: UffFunction, where: str) -> tuple[int | None, float | None]:
    """Return averages and window decay in rad/s; None where they are not told."""
    words = _ESTIMATE.fullmatch(function.identification[1])
    if words is None:
        return None, None
    return int(words[1]) or None, _number(words[2], where)


def response_dof(function: UffFunction) -> ToldDof:
    """Return node and direction of the response."""
    return _dof(function.response_node, function.response_direction, function, "response")


def reference_dof(function: UffFunction) -> ToldDof:
    """Return node and direction of the reference."""
    return _dof(function.reference_node, function.reference_direction, function, "reference")


def _dof(node: int, code: int, function: UffFunction, what: str) -> ToldDof:
    direction = axis_direction(code)
    if direction is None:
        for line in function.identification:
            words = _DIRECTION.fullmatch(line)
            if words and words[1] == what:
                vector = np.array([_number(words[i], line) for i in (2, 3, 4)])
                length = float(np.linalg.norm(vector))
                direction = vector / length if length > 0.5 else None
    return ToldDof(str(node) if node else None, direction)


def _number(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise ForeignFileError(f"{where}: wanted a number, got {text[:30]!r}")
    return value
