"""Complex FRFs from what a file has: complex arrays, real and imaginary, magnitude and phase."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.roles import Role, tokens
from armodal.protocols.foreign.variables import Variable

__all__ = ["complex_arrays", "has_frf"]

_ESTIMATORS = ("h1", "hv", "h2")
_RADIANS = {"rad", "radian", "radians"}
_ROUND = 1.001  # a phase in rad stays within pi, printed with four digits

Found = Mapping[Role, Sequence[Variable]]


def has_frf(found: Found) -> bool:
    """Return whether there is a complex array, or parts of one."""
    pairs = ((Role.REAL, Role.IMAGINARY), (Role.MAGNITUDE, Role.PHASE))
    return bool(found.get(Role.FRF)) or any(found.get(a) and found.get(b) for a, b in pairs)


def complex_arrays(
    found: Found, origin: str, said: list[str], read_as: list[str]
) -> list[Variable]:
    """Return the FRFs as complex arrays, each with its unit.

    Raises
    ------
    ForeignFileError
        If parts do not pair, or there are none.
    """
    whole = list(found.get(Role.FRF, ()))
    if whole:
        return _one_estimator(whole, origin, said)
    if found.get(Role.REAL) and found.get(Role.IMAGINARY):
        return [
            Variable(name=re.name, values=re.values + 1j * im.values, unit=re.unit or im.unit)
            for re, im in _pairs(found, Role.REAL, Role.IMAGINARY, origin)
        ]
    if found.get(Role.MAGNITUDE) and found.get(Role.PHASE):
        return [
            _polar(size, phase, origin, said, read_as)
            for size, phase in _pairs(found, Role.MAGNITUDE, Role.PHASE, origin)
        ]
    raise ForeignFileError(
        f"{origin}: wanted complex FRFs, or real and imaginary part, or magnitude and phase, got "
        "one without the other; export both, or name them in `variables` in the manifest"
    )


def _one_estimator(whole: list[Variable], origin: str, said: list[str]) -> list[Variable]:
    """Return the FRFs of one estimator where a file has H1 beside H2 or Hv."""
    by_name = {variable.name.lower(): variable for variable in whole}
    told = [name for name in _ESTIMATORS if name in by_name]
    if len(told) < 2 or len(told) != len(whole):
        return whole
    said.append(f"{origin}: {told[0]} is used of {', '.join(told)}")
    return [by_name[told[0]]]


def _pairs(found: Found, one: Role, other: Role, origin: str) -> list[tuple[Variable, Variable]]:
    first, second = found[one], found[other]
    if len(first) != len(second) or any(
        a.values.shape != b.values.shape for a, b in zip(first, second, strict=True)
    ):
        raise ForeignFileError(
            f"{origin}: wanted a {other} part for each {one} part, got {len(first)} and "
            f"{len(second)}, or of other sizes; name them in `variables` in the manifest"
        )
    return list(zip(first, second, strict=True))


def _polar(
    size: Variable, phase: Variable, origin: str, said: list[str], read_as: list[str]
) -> Variable:
    magnitude = np.asarray(size.values, dtype=np.float64)
    words = tokens(f"{size.name} {size.unit}")
    label = size.unit
    in_db = "db" in words
    if not in_db and (magnitude < 0.0).any():
        in_db = True
        said.append(f"{origin}: {size.name[:40]} is negative somewhere: it is taken as dB")
    if in_db:
        magnitude = 10.0 ** (np.clip(magnitude, -2000.0, 2000.0) / 20.0)
        label = label.lower().removeprefix("db").strip(" ()/re1:") if "/" in label else ""
        read_as.append(f"{size.name[:40]} in dB is 20 log10 of the magnitude")
    angle = np.asarray(phase.values, dtype=np.float64)
    told = tokens(f"{phase.name} {phase.unit}")
    largest = float(np.max(np.abs(angle), initial=0.0))
    if told & _RADIANS:
        radians = angle
    elif told & {"deg", "degree", "degrees", "grad"} or "°" in phase.name + phase.unit:
        radians = np.radians(angle)
    else:
        in_rad = largest <= np.pi * _ROUND
        radians = angle if in_rad else np.radians(angle)
        unit = "rad" if in_rad else "degrees"
        said.append(
            f"{origin}: {phase.name[:40]} reaches {largest:.4g}: it is taken as {unit}; name its "
            "unit in the header, such as phase [deg]"
        )
    return Variable(name=size.name, values=magnitude * np.exp(1j * radians), unit=label)
