"""The time records of a universal file as named arrays, each record a signal."""

from __future__ import annotations

import numpy as np

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.even import is_even
from armodal.protocols.foreign.measured import AXES
from armodal.protocols.foreign.uff_hits import SIX_DIGITS
from armodal.protocols.foreign.uff_records import FunctionKind, UffFile, UffFunction
from armodal.protocols.foreign.variables import Axis, Variable, Variables

__all__ = ["uff_signals"]


def uff_signals(file: UffFile, origin: str) -> tuple[Variables, ...]:
    """Return the channels of each record; a channel that comes again begins the next record.

    Signals are called by their point and direction, such as `3 z`, or `3` where none is told.

    Raises
    ------
    ForeignFileError
        If there are none, or dataset 164 gives units that no label of a channel repeats.
    """
    records: list[list[UffFunction]] = []
    seen: set[tuple[int, int]] = set()
    for function in file.functions:
        if function.kind != FunctionKind.TIME_RESPONSE:
            continue
        key = (function.response_node, function.response_direction)
        if not records or key in seen:
            records.append([])
            seen = set()
        records[-1].append(function)
        seen.add(key)
    if not records:
        raise ForeignFileError(
            f"{origin}: wanted time records (dataset 58, function type 1) beside a file of the "
            "force, got none; export the time records"
        )
    return tuple(
        _record(record, origin if len(records) == 1 else f"{origin}: record {i + 1}", file)
        for i, record in enumerate(records)
    )


def _record(record: list[UffFunction], where: str, file: UffFile) -> Variables:
    units = file.units
    scaled = units is not None and (units.force, units.length) != (1.0, 1.0)
    if scaled and not all(function.numerator_unit for function in record):
        raise ForeignFileError(
            f"{where}: wanted units that channels name themselves, dataset 164 alone gives other "
            "ones than SI; export in SI, or force and responses in one file"
        )
    times = np.asarray(record[0].abscissa, dtype=np.float64)
    even = is_even(times)
    step = float(times[-1] - times[0]) / (len(times) - 1) if even else 0.0
    axis = Axis(unit="s", first=float(times[0]), step=step, rounding=SIX_DIGITS) if even else None
    columns = () if even else (Variable(name="time", values=times),)
    signals = [
        Variable(name=_name(function), values=function.values, unit=function.numerator_unit)
        for function in record
    ]
    return Variables(origin=where, format="universal", variables=(*columns, *signals), axis=axis)


def _name(function: UffFunction) -> str:
    code = function.response_direction
    if not 1 <= abs(code) <= len(AXES):
        return f"{function.response_node}"
    return f"{function.response_node} {'-' if code < 0 else ''}{AXES[abs(code) - 1]}"
