"""The hit in named arrays: a force and simultaneous accelerations over even times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.measured import (
    ForeignHit,
    Hints,
    NotToldError,
    ToldDof,
    check_signals,
    exact_rate,
)
from armodal.protocols.foreign.roles import Role, tokens
from armodal.protocols.foreign.uff_records import DataKind
from armodal.protocols.foreign.units import SI, seconds, signal_scale, unit
from armodal.protocols.foreign.variables import Axis, Variable, Variables

__all__ = ["MOST_TRIMMED", "hit_of"]

MOST_TRIMMED = 8  # samples: what channels and blocks are apart that one device recorded
_MOST_CHANNELS = 64
_FEWEST_SAMPLES = 64
_COARSE = 1e-5  # relative: a step printed with fewer than five digits
_PLAIN_TIMES = frozenset(
    {"time", "t", "zeit", "temps", "domain", "axis", "elapsed", "vector", "values", "column"}
)
_SIGNALS = (Role.RESPONSE, Role.UNKNOWN, Role.MAGNITUDE)

Found = Mapping[Role, Sequence[Variable]]
Signal = npt.NDArray[np.float64]


def hit_of(part: Variables, found: Found, hints: Hints, said: list[str]) -> ForeignHit:
    """Return the hit of named arrays in SI.

    Raises
    ------
    NotToldError
        If it is not told which signal is the force.
    ForeignFileError
        If there is no even time, or signals are of other lengths or not finite.
    """
    force = _rows(found.get(Role.FORCE, ()))
    responses = _rows([v for role in _SIGNALS for v in found.get(role, ())])
    if len(force) != 1 or not responses:
        raise NotToldError(
            f"{part.origin}: wanted signals called time, force and at least one acceleration, got "
            f"{len(force)} called force beside {len(responses)} others; rename them, or say "
            '`variables` in the manifest, such as { force = "CH1", response = ["CH2"] }',
            key="variables",
        )
    length, responses = _common_length(part, force[0], responses, said)
    if len(responses) + 1 > _MOST_CHANNELS:
        raise ForeignFileError(
            f"{part.origin}: wanted at most {_MOST_CHANNELS} channels, got {len(responses) + 1}; "
            "name those to read in `variables` in the manifest"
        )
    rate = _rate(part, found, length, hints, said)
    rows = [_in_si(force[0], DataKind.EXCITATION_FORCE, part, hints, said)]
    rows += [_in_si(one, DataKind.ACCELERATION, part, hints, said) for one in responses]
    signals = np.stack([row[:length] for row in rows])
    check_signals(signals, part.origin)
    told = hints.responses or tuple(ToldDof(None, None) for _ in responses)
    if len(told) != len(responses):
        raise ForeignFileError(
            f"{part.origin}: wanted {len(told)} responses, as the manifest says, got "
            f"{len(responses)}"
        )
    return ForeignHit(
        origin=part.origin,
        rate_hz=rate,
        force_n=frozen_array(signals[0], np.float64),
        acceleration_m_s2=frozen_array(signals[1:], np.float64),
        hit=hints.reference or ToldDof(None, None),
        responses=told,
    )


def _rows(variables: Sequence[Variable]) -> list[Variable]:
    """Return signals one by one: a table has one channel a row or column."""
    rows = []
    for variable in variables:
        values = np.asarray(variable.values)
        if values.size < _FEWEST_SAMPLES and max(values.shape, default=0) < 2:
            continue  # a setting, not a signal
        if values.ndim > 2 or np.iscomplexobj(values):
            continue
        table = np.atleast_2d(values)
        table = table if table.shape[0] <= table.shape[1] else table.T
        for i, row in enumerate(table):
            name = variable.name if len(table) == 1 else f"{variable.name} {i + 1}"
            rows.append(Variable(name=name, values=row, unit=variable.unit))
    return rows


def _common_length(
    part: Variables, force: Variable, responses: list[Variable], said: list[str]
) -> tuple[int, list[Variable]]:
    """Return the length of all signals, and the responses that have it."""
    n = len(force.values)
    alike = [one for one in responses if abs(len(one.values) - n) <= MOST_TRIMMED]
    other = [one.name[:40] for one in responses if one not in alike]
    if not alike:
        raise ForeignFileError(
            f"{part.origin}: wanted signals of one length, got {n} samples of force and "
            f"{len(responses[0].values)} of {responses[0].name[:40]}; export them alike"
        )
    if other:
        said.append(f"{part.origin}: of other lengths and not used: {', '.join(other)[:200]}")
    length = min(n, *(len(one.values) for one in alike))
    if any(len(one.values) != length for one in (force, *alike)):
        said.append(
            f"{part.origin}: channels differ in length: the first {length} samples are used"
        )
    return length, alike


def _rate(part: Variables, found: Found, length: int, hints: Hints, said: list[str]) -> Fraction:
    rates = []
    for time in found.get(Role.TIME, ()):
        times = np.asarray(np.real(time.values), dtype=np.float64).reshape(-1)
        if abs(len(times) - length) <= MOST_TRIMMED:
            rates.append(exact_rate(np.multiply(times, _seconds(time, part.origin)), part.origin))
    if len(set(rates)) > 1:
        raise ForeignFileError(
            f"{part.origin}: wanted one sampling rate, the columns of time have "
            f"{', '.join(f'{float(rate):g}' for rate in rates)} Hz; export the channels alike"
        )
    if rates:
        return rates[0]
    axis = part.axis if part.axis is not None and part.axis.unit == "s" else None
    if hints.rate_hz is not None:
        axis = Axis(unit="s", first=0.0, step=1.0 / hints.rate_hz)
    if axis is None:
        raise NotToldError(
            f"{part.origin}: wanted the times of {length} samples, the file does not tell them; "
            "say `rate_hz` in the manifest, or name their array in `variables`",
            key="rate_hz",
        )
    if length < _FEWEST_SAMPLES or not (np.isfinite(axis.step) and 1e-9 < axis.step < 1e3):
        raise ForeignFileError(
            f"{part.origin}: wanted {_FEWEST_SAMPLES} samples or more at a rate above 0, got "
            f"{length} samples {axis.step:g} s apart; export the whole record"
        )
    times = axis.step * np.arange(length, dtype=np.float64)
    rate = exact_rate(times, part.origin, rounding=axis.rounding)
    if axis.rounding > _COARSE:
        said.append(
            f"{part.origin}: samples are {axis.step:g} s apart by few digits: the rate is taken as "
            f"{float(rate):g} Hz; say `rate_hz` in the manifest if it is another"
        )
    return rate


def _seconds(time: Variable, origin: str) -> float:
    """Return seconds per unit of a time column: `time`, `time [ms]`, `t_us`."""
    if not time.unit and all(word in _PLAIN_TIMES or word.isdigit() for word in tokens(time.name)):
        return 1.0
    factor = seconds(time.unit)
    if factor is None:
        name = f"{time.name} [{time.unit}]" if time.unit else time.name
        raise ForeignFileError(
            f"{origin}: wanted a time in s, ms or us, such as 'time [ms]' or 'time_s', got "
            f"{name[:40]!r}; convert it, or rename it"
        )
    return factor


def _in_si(
    signal: Variable, kind: DataKind, part: Variables, hints: Hints, said: list[str]
) -> Signal:
    values = np.asarray(signal.values, dtype=np.float64)
    is_force = kind is DataKind.EXCITATION_FORCE
    scale = hints.force_scale if is_force else hints.response_scale
    if scale is not None:
        return values * scale
    label = (hints.force_unit if is_force else hints.response_unit) or signal.unit
    if not label:
        said.append(
            f"{part.origin}: the units are not told; the numbers are taken as SI (N, m/s^2). "
            "Say `units` in the manifest"
        )
        return values
    if unit(label) is None and label != SI:
        raise NotToldError(
            f"{part.origin}: wanted {signal.name[:40]} in a unit such as N or m/s^2, got "
            f"{label!r}; say `units`, or `scale` with the N and m/s^2 per unit, in the manifest, "
            "such as scale = { force = 22.4, response = 98.1 }",
            key="scale",
        )
    return values * signal_scale(kind, label, None, part.origin).factor
