"""Units of an FRF: a motion over a force, however a program writes the ratio."""

from __future__ import annotations

import re

from armodal.protocols.foreign.uff_records import DataKind, UffFunction, UffUnits
from armodal.protocols.foreign.units import QUANTITIES, Scale, signal_scale, unit
from armodal.protocols.frf_records import FrfForm

__all__ = ["KIND_OF_FORM", "frf_form", "frf_scale", "frf_unit", "split_ratio"]

_INVERSE_FIRST = re.compile(r"\(?1/([^()*/]+)\)?\*?(.+)")  # (1/N)*(m/s²)
_TWO_BRACKETS = re.compile(r"\((.+)\)\(([^()]+)\)")  # (m/s²)(N), a ratio by the words beside it
KIND_OF_FORM = {
    FrfForm.RECEPTANCE: DataKind.DISPLACEMENT,
    FrfForm.MOBILITY: DataKind.VELOCITY,
    FrfForm.ACCELERANCE: DataKind.ACCELERATION,
}
_FORMS = {
    "displacement": FrfForm.RECEPTANCE,
    "velocity": FrfForm.MOBILITY,
    "acceleration": FrfForm.ACCELERANCE,
}


def split_ratio(label: str) -> tuple[str, str]:
    """Split `(m/s^2)/N` or `g/N` where one part is a force; else no second part.

    >>> split_ratio("(1/N)*(m/s^2)")
    ('(m/s^2)', 'N')
    """
    text = label.replace(" ", "").replace("·", "*")
    top, _, bottom = text.rpartition("/")
    for match in (_INVERSE_FIRST.fullmatch(text), _TWO_BRACKETS.fullmatch(text)):
        if match:
            top, bottom = match.groups()
            if match.re is _INVERSE_FIRST:
                top, bottom = bottom, top
    told = unit(bottom)
    return (top, bottom) if told is not None and told[0] == "force" and top else (label, "")


def frf_unit(label: str) -> tuple[FrfForm, float] | None:
    """Return the form and the factor to SI that an FRF's unit tells; None if it tells neither.

    >>> frf_unit("(m/s²)/N")
    (<FrfForm.ACCELERANCE: 'accelerance'>, 1.0)
    >>> frf_unit("V/V") is None
    True
    """
    top, bottom = split_ratio(label)
    motion, force = unit(top), unit(bottom)
    if not bottom or motion is None or force is None or motion[0] not in _FORMS:
        return None
    return _FORMS[motion[0]], motion[1] / force[1]


def frf_form(function: UffFunction) -> FrfForm | None:
    """Return the form the data types of an FRF tell, None where they do not.

    The labels speak where the data types are silent.
    """
    force = _quantity(function.denominator, function.denominator_unit) == "force"
    response = _quantity(function.numerator, function.numerator_unit)
    if not force and response is None:
        response, force = _ratio_quantities(function.numerator_unit)
    if not force:
        return None
    return _FORMS.get(response or "")


def frf_scale(function: UffFunction, form: FrfForm, units: UffUnits | None, origin: str) -> Scale:
    """Return the factor that turns an FRF of a universal file into SI."""
    label, below = function.numerator_unit, function.denominator_unit
    top, bottom = split_ratio(label)
    if bottom:
        label, below = top, below or bottom
    response = signal_scale(KIND_OF_FORM[form], label, units, origin)
    force = signal_scale(DataKind.EXCITATION_FORCE, below, units, origin)
    return Scale(response.factor / force.factor, response.assumed or force.assumed)


def _quantity(kind: int, label: str) -> str | None:
    for known, quantity in QUANTITIES.items():
        if known == kind:
            return quantity
    told = unit(label) if label else None
    return None if told is None else told[0]


def _ratio_quantities(label: str) -> tuple[str | None, bool]:
    top, bottom = split_ratio(label)
    told = unit(top)
    return (None if told is None else told[0]), bool(bottom)
