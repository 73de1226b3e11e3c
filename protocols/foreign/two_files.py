"""Hits whose force is in another file than their responses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.even import is_counter, is_even
from armodal.protocols.foreign.hit_variables import hits_in, sampling_rate
from armodal.protocols.foreign.measured import Content, ForeignHit, Hints, NotToldError
from armodal.protocols.foreign.roles import Role, role_of
from armodal.protocols.foreign.variables import Axis, Variable, Variables, listing, one_line

__all__ = ["content_of_two"]

_SAME_RATE = 1e-5  # relative: a step printed with six digits
_FEWEST_SAMPLES = 64
_SIGNALS = {Role.FORCE, Role.RESPONSE, Role.UNKNOWN, Role.MAGNITUDE}


@dataclass(frozen=True, slots=True)
class _Signals:
    """The signals of one section of a file, and the rate that it tells."""

    part: Variables
    signals: list[Variable]  # (n,) or (k, n) each
    rate_hz: Fraction | None
    begins_s: float | None  # by a column of times

    @property
    def length(self) -> int:
        """Samples of the shortest signal."""
        return int(min(max(one.values.shape) for one in self.signals))


def content_of_two(
    force: Sequence[Variables], responses: Sequence[Variables], hints: Hints
) -> Content:
    """Return the hits of a file of forces and a file of responses, section by section.

    Raises
    ------
    NotToldError
        If no file tells the sampling rate, or which signal is the force.
    ForeignFileError
        If the files do not belong together, or one holds no signals; the message ends with what was
        found in both.
    """
    listed = tuple(
        replace(one, name=f"{one.name[:20]} of {part.origin}")
        for part in (*force, *responses)
        for one in part.listed
    )
    said: list[str] = []
    try:
        hits = _hits(force, responses, hints, said)
    except NotToldError as error:
        raise NotToldError(one_line(error.why), key=error.key, listed=listed) from error
    except ForeignFileError as error:
        raise ForeignFileError(f"{one_line(str(error))}; {listing(listed)}") from error
    return Content(
        origin=responses[0].origin,
        hits=tuple(hits),
        said=tuple(dict.fromkeys(said)),
        found=listed,
    )


def _hits(
    force: Sequence[Variables], responses: Sequence[Variables], hints: Hints, said: list[str]
) -> list[ForeignHit]:
    if not force or len(force) != len(responses):
        raise ForeignFileError(
            f"wanted as many records of force as of responses, got {len(force)} and "
            f"{len(responses)}; export both alike"
        )
    hits = []
    for pushing, moving in zip(force, responses, strict=True):
        said += [*pushing.said, *moving.said]
        one = _signals(pushing, Role.FORCE, hints, said)
        if len(one.signals) != 1:
            names = ", ".join(signal.name[:40] for signal in one.signals)
            raise NotToldError(
                f"{pushing.origin}: wanted one force, got {len(one.signals)} signals "
                f"({names[:200]}); name it in the manifest, such as variables = {{ force = "
                '"CH1" }',
                key="variables",
            )
        hits += _together(one, _signals(moving, Role.RESPONSE, hints, said), hints, said)
    return hits


def _together(
    force: _Signals, responses: _Signals, hints: Hints, said: list[str]
) -> list[ForeignHit]:
    where = f"{responses.part.origin} with {force.part.origin}"
    rates = [rate for rate in (responses.rate_hz, force.rate_hz) if rate is not None]
    if rates and abs(float(rates[-1] / rates[0]) - 1.0) > _SAME_RATE:
        raise ForeignFileError(
            f"{where}: wanted one sampling rate, the responses have {float(rates[0]):g} Hz, the "
            f"force {float(rates[-1]):g} Hz; export or resample both alike"
        )
    if force.begins_s is not None and responses.begins_s is not None and rates:
        apart_s = abs(force.begins_s - responses.begins_s)
        if apart_s * float(rates[0]) > 0.5:
            raise ForeignFileError(
                f"{where}: wanted both from the same time on, the force begins at "
                f"{force.begins_s:g} s, the responses at {responses.begins_s:g} s; export the same "
                "stretch"
            )
    length = min(force.length, responses.length)
    longest = max(force.length, responses.length)
    if length < longest:
        said.append(f"{where}: {length} and {longest} samples long: the first {length} are used")
    pushing = Variable(
        name="force",
        values=_first(force.signals[0], length).values,
        unit=force.signals[0].unit,
    )
    part = replace(
        responses.part,
        origin=where,
        axis=Axis(unit="s", first=0.0, step=float(1 / rates[0])) if rates else None,
    )
    found = {
        Role.FORCE: [pushing],
        Role.RESPONSE: [_first(one, length) for one in responses.signals],
    }
    return hits_in(part, found, replace(hints, rate_hz=None) if rates else hints, said)


def _first(signal: Variable, length: int) -> Variable:
    """The first samples of a signal; of a matrix along its longer side."""
    values = signal.values
    along = int(np.argmax(values.shape))
    return replace(signal, values=np.take(values, np.arange(length), axis=along))


def _signals(part: Variables, role: Role, hints: Hints, said: list[str]) -> _Signals:
    """Return the times and signals in one section of a file that holds only one kind."""
    times, signals = _mapped(part, role, hints) or _by_name(part, role)
    signals = [
        one
        for one in signals
        if not one.is_complex
        and one.values.ndim in {1, 2}
        and max(one.values.shape) >= _FEWEST_SAMPLES
    ]
    if not signals:
        raise ForeignFileError(
            f"{part.origin}: wanted a record of {role} of {_FEWEST_SAMPLES} samples or more, got "
            "none; export the whole record"
        )
    length = min(max(one.values.shape) for one in signals)
    try:
        rate = sampling_rate(part, {Role.TIME: times}, length, hints, said)
    except NotToldError:
        rate = None
    told = times and times[0].values.size and not times[0].is_complex
    begins = float(np.ravel(times[0].values)[0]) if told and rate is not None else None
    return _Signals(part, signals, rate, begins)


def _mapped(
    part: Variables, role: Role, hints: Hints
) -> tuple[list[Variable], list[Variable]] | None:
    """Return the arrays that the manifest names for times and for signals; None for neither."""
    by_name = {one.name: one for one in part.variables}
    names = hints.variables.get(role.value, ())
    if not names:
        return None
    missing = [name for name in names if name not in by_name]
    if missing:
        raise ForeignFileError(
            f"{part.origin}: variables.{role}: wanted the name of an array in the file, got "
            f"{missing[0][:60]!r}"
        )
    told = hints.variables.get(Role.TIME.value, ())
    times = [by_name[name] for name in told if name in by_name]
    return times or _by_name(part, role)[0], [by_name[name] for name in names]


def _by_name(part: Variables, role: Role) -> tuple[list[Variable], list[Variable]]:
    """Return times and signals by names, or by numbers where there are none."""
    columns = [one for one in part.variables if one.values.size]
    if not part.named:
        if len(columns) > 1 and is_counter(columns[0].values):
            columns = columns[1:]  # numbers of samples
        if len(columns) > 1 and is_even(columns[0].values):
            return [replace(columns[0], name="time")], columns[1:]
        return [], columns
    roles = [role_of(one.name, one.unit, is_complex=one.is_complex) for one in columns]
    times = [one for one, own in zip(columns, roles, strict=True) if own is Role.TIME]
    own = [one for one, told in zip(columns, roles, strict=True) if told is role]
    others = [one for one, told in zip(columns, roles, strict=True) if told in _SIGNALS]
    if not times and len(others) > 1 and part.is_table and is_even(others[0].values):
        times, others = [replace(others[0], name="time")], others[1:]
    return times, own or others
