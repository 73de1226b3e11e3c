"""What unnamed columns are, by their numbers: a time record or an FRF, and which column is what.

A first column that rises evenly is the axis. Steps of a hammer test's time are shorter than
2 ms (500 Hz), steps of its frequencies longer than 5 ms would be as a time; in between, and where
the other columns contradict it, nothing is decided here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.even import is_counter, is_even, never_falls
from armodal.protocols.foreign.frf_variables import Words
from armodal.protocols.foreign.measured import Hints, NotToldError
from armodal.protocols.foreign.roles import Role
from armodal.protocols.foreign.units import hertz, seconds
from armodal.protocols.foreign.variables import Variable, Variables

__all__ = ["parts_by_numbers", "roles_by_numbers"]

_LONGEST_SAMPLE_S = 2e-3
_FINEST_LINE_HZ = 5e-3
_PULSE_SIDES = 5.0  # a pulse over the largest swing to its other side
_MOST_COHERENCE = 1.5
_ROUND = 1.001

Found = Mapping[Role, Sequence[Variable]]


def roles_by_numbers(part: Variables, hints: Hints, words: Words) -> Found:
    """Return the columns of a table without names by what their numbers are.

    Raises
    ------
    NotToldError
        If the numbers do not tell; the message says how to.
    """
    columns = list(part.variables)
    if len(columns) > 2 and is_counter(columns[0].values) and is_even(columns[1].values):
        columns = columns[1:]  # a counter before the axis
    if any(column.is_complex for column in columns):
        return _complex_columns(columns)
    columns = _without_coarse_axis(columns, part, hints, words)
    if part.axis is not None or hints.rate_hz is not None or hints.line_spacing_hz is not None:
        kind = hints.kind or ("frf" if hints.line_spacing_hz is not None else "hit")
        if part.axis is not None and part.axis.unit == "Hz":
            kind = "frf"
        if not (kind == "hit" and is_even(columns[0].values) and len(columns) > 2):
            return (
                parts_by_numbers(columns, part, words)
                if kind == "frf"
                else _signals(columns, part, words)
            )
    if len(columns) < 3 or not is_even(columns[0].values):
        raise NotToldError(
            f"{part.origin}: wanted rows of time, force and at least one acceleration, or of "
            "frequency, real and imaginary part, the first rising evenly, got "
            f'{len(part.variables)} columns that are neither; say `kind` ("hit" or "frf") and '
            "`rate_hz` or `line_spacing_hz`, or `variables`, in the manifest, or `force`, where "
            "that is in a file of its own",
            key="kind",
        )
    axis, rest = columns[0], columns[1:]
    kind = hints.kind or ("frf" if hints.form is not None else _kind(axis, rest, part, words))
    if kind == "frf":
        return {Role.FREQUENCY: [axis], **parts_by_numbers(rest, part, words)}
    return {Role.TIME: [_named(axis, "time")], **_signals(rest, part, words)}


def _without_coarse_axis(
    columns: list[Variable], part: Variables, hints: Hints, words: Words
) -> list[Variable]:
    """The columns without an axis printed too coarsely to tell its step, where that is told."""
    axis = columns[0].values
    if len(columns) < 3 or is_even(axis) or not never_falls(axis):
        return columns
    if hints.rate_hz is None and hints.line_spacing_hz is None:
        raise NotToldError(
            f"{part.origin}: the first column rises, from {axis[0]:g} to {axis[-1]:g}, but not in "
            "equal steps, as a time printed with few digits does: say `rate_hz` (of a time) or "
            "`line_spacing_hz` (of a frequency) in the manifest",
            key="rate_hz",
        )
    words.said.append(
        f"{part.origin}: the first column is printed with too few digits to tell its step: the one "
        "told in the manifest is used"
    )
    return columns[1:]


def _kind(axis: Variable, rest: Sequence[Variable], part: Variables, words: Words) -> str:
    """Return "hit" or "frf" by the step of the axis, if the columns agree."""
    if hertz(axis.unit) is not None:
        return "frf"
    if seconds(axis.unit) is not None:
        return "hit"
    values = axis.values
    step = float(values[-1] - values[0]) / (len(values) - 1)
    pulse = _is_pulse(rest[0].values) and not _like_polar(rest[0].values, rest[1].values)
    if step <= _LONGEST_SAMPLE_S:
        words.read_as.append(f"the first column rises by {step:.4g}: it is taken as time in s")
        return "hit"
    if step >= _FINEST_LINE_HZ and not pulse and float(values[0]) >= 0.0:
        words.said.append(
            f"{part.origin}: the first column rises by {step:.4g}, too slowly for a time of hits: "
            "it is taken as frequency in Hz"
        )
        return "frf"
    raise NotToldError(
        f"{part.origin}: it is not told whether the first column, that rises by {step:.4g}, is a "
        'time in s or a frequency in Hz: say `kind = "hit"` or `kind = "frf"` in the manifest, or '
        "name the columns in a first line, such as 'time [s]' or 'frequency [Hz]'",
        key="kind",
    )


def _complex_columns(columns: Sequence[Variable]) -> Found:
    """Complex columns are FRFs, a real and rising one before them the frequency."""
    first = columns[0]
    is_axis = len(columns) > 1 and not np.any(np.imag(first.values)) and is_even(first.values)
    found: dict[Role, Sequence[Variable]] = {Role.FRF: columns[1:] if is_axis else columns}
    if is_axis:
        found[Role.FREQUENCY] = [first]
    return found


def parts_by_numbers(rest: Sequence[Variable], part: Variables, words: Words) -> Found:
    """Return columns behind a frequency as pairs of parts, and a coherence where one is left over.

    Raises
    ------
    NotToldError
        If the columns do not pair.
    """
    coherence: list[Variable] = []
    if len(rest) == 3 and _like_coherence(rest[2].values):
        words.said.append(f"{part.origin}: the last column is from 0 to 1: taken as coherence")
        rest, coherence = rest[:2], [rest[2]]
    if len(rest) % 2:
        raise NotToldError(
            f"{part.origin}: wanted pairs of real and imaginary part behind the frequency, got "
            f"{len(rest)} columns; say `variables` in the manifest, such as "
            '{ frequency = "column 1", real = "column 2", imaginary = "column 3" }',
            key="variables",
        )
    first, second = list(rest[::2]), list(rest[1::2])
    polar = all(_like_polar(a.values, b.values) for a, b in zip(first, second, strict=True))
    names = (Role.MAGNITUDE, Role.PHASE) if polar else (Role.REAL, Role.IMAGINARY)
    how = "by their signs and range" if polar else "part"
    words.said.append(
        f"{part.origin}: the columns are not named after their parts: they are taken as "
        f"{names[0]} and {names[1]} {how}"
    )
    return {names[0]: first, names[1]: second, Role.COHERENCE: coherence}


def _signals(rest: Sequence[Variable], part: Variables, words: Words) -> Found:
    """Columns of a hit: the first is the force, unless it swings and just one other is a push."""
    if len(rest) < 2:
        raise ForeignFileError(
            f"{part.origin}: wanted a force and at least one acceleration, got {len(rest)} column"
        )
    pushes = [i for i, column in enumerate(rest) if _is_pulse(column.values)]
    at = pushes[0] if len(pushes) == 1 else 0
    if at:
        words.read_as.append(
            f"{rest[at].name} is one push, {rest[0].name} swings to both sides: "
            f"{rest[at].name} is taken as the force"
        )
    return {Role.FORCE: [rest[at]], Role.RESPONSE: [*rest[:at], *rest[at + 1 :]]}


def _named(variable: Variable, name: str) -> Variable:
    return Variable(name=name, values=variable.values, unit=variable.unit)


def _is_pulse(values: npt.NDArray[np.float64]) -> bool:
    """Whether a column goes to one side far more than to the other, as a hammer's force does.

    A record begins before the hit: what is largest at its first value is no pulse, but an FRF
    that drift has blown up near 0 Hz.
    """
    if not len(values) or int(np.argmax(np.abs(values))) == 0:
        return False
    high, low = float(np.max(values)), -float(np.min(values))
    return max(high, low) > _PULSE_SIDES * max(min(high, low), 0.0)


def _like_coherence(values: npt.NDArray[np.float64]) -> bool:
    return bool(values.min() >= 0.0 and values.max() <= _MOST_COHERENCE)


def _like_polar(size: npt.NDArray[np.float64], phase: npt.NDArray[np.float64]) -> bool:
    """Whether two columns are magnitude and phase: never negative, and within half a turn."""
    largest = float(np.max(np.abs(phase)))
    half_turn = np.pi if largest <= np.pi * _ROUND else 180.0
    return bool(size.min() >= 0.0) and half_turn / 2.0 < largest <= half_turn * _ROUND
