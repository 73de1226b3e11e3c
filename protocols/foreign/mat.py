"""MATLAB files (version 5 to 7.2) as named arrays, read by scipy.

Fields of a struct are named after it, `Signal.y_values`; texts and lists of texts are kept apart.
Every element that scipy will read is walked before (`mat_elements`).
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.io

from armodal.protocols.bounds import MOST_NUMBERS
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.mat_elements import plain_variables
from armodal.protocols.foreign.roles import is_unit, split_unit
from armodal.protocols.foreign.variables import Axis, Listed, Variable, Variables

__all__ = ["mat_variables"]

_MOST_VARIABLES = 1000
_MOST_TEXTS = 100_000
_OF_A_FUNCTION = (".function_record.name", ".function_record.type")


def mat_variables(data: bytes, origin: str) -> tuple[Variables, ...]:
    """Return the variables of a MATLAB file.

    Raises
    ------
    ForeignFileError
        If the file is damaged or too large.
    """
    stream: Any = io.BytesIO(data)  # scipy reads streams too; its type stubs know names only
    try:
        names = plain_variables(data)
        listed = scipy.io.whosmat(stream)
        numbers = sum(math.prod(int(n) for n in shape) for _, shape, _ in listed)
        if numbers <= MOST_NUMBERS and len(listed) <= _MOST_VARIABLES:
            stream.seek(0)
            loaded = scipy.io.loadmat(stream, variable_names=names)
            return (_part(loaded, listed, origin),)
    except Exception as error:  # scipy's reader raises whatever its parser meets
        raise ForeignFileError(
            f"{origin}: wanted a MATLAB file, it cannot be read ({str(error)[:160]}); save it "
            "again with '-v7'"
        ) from error
    raise ForeignFileError(
        f"{origin}: wanted at most {MOST_NUMBERS} numbers in {_MOST_VARIABLES} variables, got "
        f"{numbers} in {len(listed)}; split the file"
    )


def _part(loaded: dict[str, Any], listed: list[Any], origin: str) -> Variables:
    variables: list[Variable] = []
    texts: dict[str, tuple[str, ...]] = {}
    others = [
        Listed(name=name, shape=tuple(shape), type=str(kind))
        for name, shape, kind in listed
        if name not in loaded
    ]
    for name, value in loaded.items():
        if name.startswith("__"):
            continue
        for path, array in _flat(name, np.asarray(value)):
            if array.dtype.kind in "fiucb" and array.size:
                wanted = np.complex128 if array.dtype.kind == "c" else np.float64
                values = _lean(array, wanted)
                variables.append(Variable(name=path, values=values, unit=split_unit(path)[1]))
            elif array.dtype.kind in "UO" and array.size and _words(array):
                texts[path] = tuple(_words(array))
            else:
                kind = array.dtype.name
                others.append(Listed(name=path, shape=array.shape, type=kind))
    axis, used = _told_axis(variables, texts)
    about = tuple(path for path in texts if path.endswith(_OF_A_FUNCTION))
    return Variables(
        origin=origin,
        format="MATLAB",
        variables=tuple(
            _with_told_unit(v, texts)
            for v in variables
            if v.name not in used and not (v.values.size == 1 and _is_detail(v.name))
        ),
        texts={
            path: text for path, text in texts.items() if path not in about and not _is_detail(path)
        },
        others=tuple(others),
        axis=axis,
        words=" ".join(word for path in about for word in texts[path]),
    )


def _told_axis(
    variables: list[Variable], texts: dict[str, tuple[str, ...]]
) -> tuple[Axis | None, tuple[str, ...]]:
    """Return an axis told by first value and step, and the names of what tells it.

    Fields of a struct as Simcenter Testlab writes it: x_values.start_value and
    x_values.increment, with the unit in x_values.quantity.label.
    """
    scalars = {v.name: v.values for v in variables if v.values.size == 1 and not v.is_complex}
    for name, step in scalars.items():
        owner = name.removesuffix(".increment")
        unit = texts.get(f"{owner}.quantity.label", ("",))[0]
        first = scalars.get(f"{owner}.start_value")
        if owner != name and first is not None and unit in {"Hz", "s"}:
            start, width = (float(value.reshape(-1)[0].real) for value in (first, step))
            if np.isfinite(start) and np.isfinite(width) and width > 0.0:
                told = (name, f"{owner}.start_value", f"{owner}.number_of_values")
                return Axis(unit=unit, first=start, step=width), told
    return None, ()


def _is_detail(path: str) -> bool:
    """Whether a field only tells how a unit is made up."""
    return any(word in path for word in (".unit_transformation.", ".quantity_terms"))


def _with_told_unit(variable: Variable, texts: dict[str, tuple[str, ...]]) -> Variable:
    """Return the values of y_values.values in the unit of y_values.quantity.label."""
    owner = variable.name.removesuffix(".values")
    label = texts.get(f"{owner}.quantity.label", ("",))[0]
    told = owner != variable.name and not variable.unit and is_unit(label)
    return replace(variable, unit=label) if told else variable


def _lean(array: npt.NDArray[Any], wanted: Any) -> npt.NDArray[Any]:
    """Return a vector as one: MATLAB has no arrays of one dimension."""
    numbers = np.asarray(array, dtype=wanted)
    vector = numbers.ndim == 2 and 1 in numbers.shape and numbers.size > 1
    return numbers.reshape(-1) if vector else numbers


def _flat(name: str, value: npt.NDArray[Any]) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    """Yield arrays by their names, fields of structs one by one."""
    if value.dtype.names is None:
        yield name, value
        return
    for i, element in enumerate(value.reshape(-1)[:_MOST_VARIABLES]):
        prefix = name if value.size == 1 else f"{name}({i + 1})"
        for key in value.dtype.names:
            yield from _flat(f"{prefix}.{key}", np.asarray(element[key]))


def _words(value: npt.NDArray[Any]) -> list[str]:
    """Return a char array's text, or a cell array's texts."""
    if value.size > _MOST_TEXTS:
        return []
    words = []
    for item in value.reshape(-1):
        cell = np.asarray(item).reshape(-1)
        if cell.size == 1 and isinstance(cell[0], str):
            words.append(str(cell[0]).strip())
    return words
