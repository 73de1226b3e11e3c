"""The hit in named arrays: a force and simultaneous accelerations over even times."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.measured import (
    ForeignHit,
    Hints,
    NotToldError,
    ToldDof,
    check_signals,
    exact_rate,
    parse_dof,
)
from armodal.protocols.foreign.recording import Recording, cut_recording
from armodal.protocols.foreign.roles import Role, tokens
from armodal.protocols.foreign.uff_records import DataKind
from armodal.protocols.foreign.units import SI, seconds, signal_scale, unit
from armodal.protocols.foreign.variables import Axis, Variable, Variables

__all__ = ["MOST_TRIMMED", "hits_in", "sampling_rate"]

MOST_TRIMMED = 8  # samples: what channels and blocks are apart that one device recorded
_MOST_CHANNELS = 64
_FEWEST_SAMPLES = 64
_COARSE = 1e-5  # relative: a step printed with fewer than five digits
_PLAIN_TIMES = frozenset(
    {"time", "t", "zeit", "temps", "domain", "axis", "elapsed", "vector", "values", "column"}
)
_DOF_NAME = re.compile(r"(?<!\d)(\d{1,9})[\s_:.-]*?([+-]?)([xyzXYZ])$")  # acc 3 x, P12:-Y
_SIGNALS = (Role.RESPONSE, Role.UNKNOWN, Role.MAGNITUDE)

Found = Mapping[Role, Sequence[Variable]]
Signal = npt.NDArray[np.float64]


def hits_in(part: Variables, found: Found, hints: Hints, said: list[str]) -> list[ForeignHit]:
    """Return the hits of named arrays in SI, cut apart where a record holds many.

    Raises
    ------
    NotToldError
        If it is not told which signal is the force, or what several hammers hit.
    ForeignFileError
        If there is no even time, or signals are of other lengths or not finite.
    """
    stacked = _stacked(part, found, said)
    if stacked:
        return [hit for one in stacked for hit in _hits_of_rows(part, found, one, hints, said)]
    force = _rows(found.get(Role.FORCE, ()))
    responses = _rows([v for role in _SIGNALS for v in found.get(role, ())])
    return _hits_of_rows(part, found, _Rows(part.origin, force, responses), hints, said)


@dataclass(frozen=True, slots=True)
class _Rows:
    """Signals of one record."""

    origin: str
    force: list[Variable]
    responses: list[Variable]


def _stacked(part: Variables, found: Found, said: list[str]) -> list[_Rows]:
    """Return the hits of matrices that hold one a row: forces, and as many of each response."""
    forces = found.get(Role.FORCE, ())
    others = [v for role in _SIGNALS for v in found.get(role, ()) if v.values.ndim == 2]
    if len(forces) != 1 or forces[0].values.ndim != 2 or min(forces[0].values.shape) < 2:
        return []
    alike = [v for v in others if v.values.shape == forces[0].values.shape]
    if not alike or len(alike) < len(others):
        return []
    force, responses = _rows(forces), [_rows([one]) for one in alike]
    said.append(f"{part.origin}: {forces[0].name[:40]} has {len(force)} rows: one hit each")
    return [
        _Rows(f"{part.origin}: hit {i + 1}", [force[i]], [rows[i] for rows in responses])
        for i in range(len(force))
    ]


def _hits_of_rows(
    part: Variables, found: Found, rows: _Rows, hints: Hints, said: list[str]
) -> list[ForeignHit]:
    forces, responses = rows.force, rows.responses
    if not forces:
        forces, responses = _force_by_unit(part, responses, said)
    if not forces or not responses:
        raise NotToldError(
            f"{part.origin}: wanted signals called time, force and at least one acceleration, got "
            f"{len(forces)} called force beside {len(responses)} others; rename them, or say "
            '`variables` in the manifest, such as { force = "CH1", response = ["CH2"] }',
            key="variables",
        )
    if len(forces) > 1 and len(hints.references) != len(forces):
        names = ", ".join(one.name[:40] for one in forces)
        raise NotToldError(
            f"{part.origin}: {len(forces)} signals are forces ({names[:200]}); name the point and "
            "direction that each hammer hits with `references`, or the force to use in `variables`",
            key=f"references {len(forces)}",
        )
    length, alike = _common_length(part, forces[0], [*forces[1:], *responses], said)
    forces, responses = [forces[0], *forces[1:]], [one for one in alike if one not in forces[1:]]
    if len(responses) + len(forces) > _MOST_CHANNELS:
        raise ForeignFileError(
            f"{part.origin}: wanted at most {_MOST_CHANNELS} channels, got {len(responses) + 1}; "
            "name those to read in `variables` in the manifest"
        )
    rate = sampling_rate(part, found, length, hints, said)
    kinds = [DataKind.EXCITATION_FORCE] * len(forces) + [DataKind.ACCELERATION] * len(responses)
    signals = np.stack(
        [
            _in_si(one, kind, part, hints, said)[:length]
            for one, kind in zip([*forces, *responses], kinds, strict=True)
        ]
    )
    check_signals(signals, part.origin)
    told = hints.responses or dofs_by_name([one.name for one in responses])
    if told[0].node is not None and not hints.responses:
        said.append(f"{part.origin}: points and directions are those its channels' names end in")
    if len(told) != len(responses):
        raise ForeignFileError(
            f"{part.origin}: wanted {len(told)} responses, as the manifest says, got "
            f"{len(responses)}"
        )
    recording = Recording(
        origin=rows.origin,
        rate_hz=rate,
        forces_n=signals[: len(forces)],
        acceleration_m_s2=signals[len(forces) :],
        hammers=hints.references or (ToldDof(None, None),),
        responses=told,
    )
    return cut_recording(recording, hints.cut, said)


def _force_by_unit(
    part: Variables, signals: list[Variable], said: list[str]
) -> tuple[list[Variable], list[Variable]]:
    """Force and responses where all signals but one tell a unit of acceleration."""
    kinds = [unit(one.unit) for one in signals]
    others = [i for i, kind in enumerate(kinds) if kind is None or kind[0] != "acceleration"]
    if len(others) != 1 or len(signals) < 2 or not signals[others[0]].unit:
        return [], signals
    force = signals[others[0]]
    said.append(
        f"{part.origin}: {force.name[:40]}, in {force.unit[:20]}, is the only signal that is no "
        "acceleration: it is taken as the force"
    )
    return [force], [one for one in signals if one is not force]


def dofs_by_name(names: Sequence[str]) -> tuple[ToldDof, ...]:
    """Return points and directions that the names of channels end in; none told otherwise.

    >>> [(dof.node, dof.label) for dof in dofs_by_name(["acc 3 x", "P12:-Y"])]
    [('3', 'x'), ('12', 'y')]
    >>> dofs_by_name(["acc_x", "acc_y"])[0].node is None
    True
    """
    matches = [_DOF_NAME.search(name.strip()) for name in names]
    dofs = [parse_dof(f"{int(m[1])}:{m[2]}{m[3]}", "") for m in matches if m]
    keys = {(dof.node, tuple(np.abs(dof.direction))) for dof in dofs if dof.direction is not None}
    if len(keys) < len(names):
        return tuple(ToldDof(None, None) for _ in names)
    return tuple(dofs)


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


def sampling_rate(
    part: Variables, found: Found, length: int, hints: Hints, said: list[str]
) -> Fraction:
    """Return the rate in Hz of signals of some length, by their times, their axis or the manifest.

    Raises
    ------
    NotToldError
        If none of them tells it.
    ForeignFileError
        If they contradict one another, or the times do not rise evenly.
    """
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
