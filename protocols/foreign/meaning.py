"""What named arrays mean: FRFs or a hit, by their names and units, their numbers, the manifest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.by_numbers import parts_by_numbers, roles_by_numbers
from armodal.protocols.foreign.complex_arrays import has_frf
from armodal.protocols.foreign.even import is_even
from armodal.protocols.foreign.frf_variables import Words, frfs_of
from armodal.protocols.foreign.hit_variables import hits_in
from armodal.protocols.foreign.measured import Content, ForeignFrf, ForeignHit, Hints, NotToldError
from armodal.protocols.foreign.roles import Role, role_of
from armodal.protocols.foreign.sections import (
    is_coherence_alone,
    named_in_order,
    with_coherence,
)
from armodal.protocols.foreign.variables import Variable, Variables, listing, one_line

__all__ = ["content_of"]

Found = Mapping[Role, Sequence[Variable]]

_ANGULAR = {"w", "omega"}  # likely rad/s: not taken for Hz


def content_of(parts: Sequence[Variables], hints: Hints, origin: str) -> Content:
    """Return the FRFs and hits in the sections of a file.

    Raises
    ------
    ForeignFileError
        If they are none; the message ends with what was found.
    """
    words = Words([], [])
    listed = tuple(one for part in parts for one in part.listed)
    try:
        frfs, hits = _sections(parts, hints, words, origin)
    except NotToldError as error:
        raise NotToldError(one_line(error.why), key=error.key, listed=listed) from error
    except ForeignFileError as error:
        raise ForeignFileError(f"{one_line(str(error))}; {listing(listed)}") from error
    averages = [number for part in parts for number in _scalar(part, "averages")]
    decays = [number for part in parts for number in _scalar(part, "window_decay_rad_s")]
    return Content(
        origin=origin,
        frfs=tuple(frfs),
        hits=tuple(hits),
        averages=int(min(averages)) if averages and frfs else None,
        decay_rad_s=decays[0] if decays and frfs else None,
        said=tuple(dict.fromkeys(words.said)),
        read_as=tuple(dict.fromkeys(words.read_as)),
        found=listed,
    )


def _sections(
    parts: Sequence[Variables], hints: Hints, words: Words, origin: str
) -> tuple[list[ForeignFrf], list[ForeignHit]]:
    """Return what all sections hold; one that is neither is left out if another is."""
    frfs: list[ForeignFrf] = []
    hits: list[ForeignHit] = []
    failed: list[ForeignFileError] = []
    alone = len(parts) == 1
    for part in parts:
        words.said += part.said
        if frfs and is_coherence_alone(part):
            frfs[-1] = with_coherence(frfs[-1], part, words.said)
            continue
        try:
            found = _found(part, hints, words)
            if _is_frf(part, found, hints):
                frfs += frfs_of(
                    part, found, hints if alone else replace(hints, responses=()), words
                )
            else:
                hits += hits_in(part, found, hints, words.said)
        except ForeignFileError as error:
            asked = isinstance(error, NotToldError) and error.key not in {"kind", "variables"}
            if alone or asked:
                raise
            failed.append(error)
    if failed and not frfs and not hits:
        raise failed[0]
    words.said += [f"{error}: it is left out" for error in failed]
    return frfs if alone else named_in_order(frfs, hints, origin), hits


def _found(part: Variables, hints: Hints, words: Words) -> Found:
    """Return the arrays by what they are."""
    if hints.variables:
        return _mapped(part, hints)
    if not part.named:
        return roles_by_numbers(part, hints, words)
    found: dict[Role, list[Variable]] = {}
    for variable in part.variables:
        role = role_of(variable.name, variable.unit, is_complex=variable.is_complex)
        found.setdefault(role, []).append(variable)
    for axis in (Role.TIME, Role.FREQUENCY):
        _only_rising(part, found, axis)
    _first_column(part, found)
    _frequencies_by_size(part, found, words)
    rest = found.get(Role.UNKNOWN, ())
    is_frf = bool(found.get(Role.FREQUENCY)) and not found.get(Role.TIME)
    if part.is_table and is_frf and not has_frf(found) and len(rest) > 1:
        return {**found, **parts_by_numbers(rest, part, words)}
    return found


def _first_column(part: Variables, found: dict[Role, list[Variable]]) -> None:
    """Take the first column of a table for its axis if it rises evenly and is not named."""
    has_axis = found.get(Role.TIME) or found.get(Role.FREQUENCY)
    if has_axis or not part.is_table or not part.variables:
        return
    first = part.variables[0]
    unknown = found.get(Role.UNKNOWN, [])
    if first not in unknown or not is_even(first.values):
        return
    signals = found.get(Role.FORCE) or found.get(Role.RESPONSE)
    if signals or has_frf(found):
        axis = Role.FREQUENCY if has_frf(found) else Role.TIME
        found[axis] = [Variable(name=axis, values=first.values)]
        unknown.remove(first)


def _frequencies_by_size(part: Variables, found: dict[Role, list[Variable]], words: Words) -> None:
    """Take the one array that rises and has as many values as an FRF lines for its frequencies."""
    if found.get(Role.FREQUENCY) or not has_frf(found):
        return
    frfs = [v for role in (Role.FRF, Role.REAL, Role.MAGNITUDE) for v in found.get(role, ())]
    sizes = {size for variable in frfs for size in variable.values.shape}
    rising = [
        (role, v)
        for role in (Role.UNKNOWN, Role.FORCE)
        for v in found.get(role, ())
        if v.values.size in sizes and v.name.lower() not in _ANGULAR and _rises(v)
    ]
    if len(rising) == 1:
        role, axis = rising[0]
        found[role].remove(axis)
        found[Role.FREQUENCY] = [Variable(name="frequency", values=axis.values)]
        words.said.append(
            f"{part.origin}: {axis.name[:40]} rises and has a value a line: it is taken as the "
            "frequencies in Hz"
        )


def _mapped(part: Variables, hints: Hints) -> Found:
    """Return the arrays that the manifest names, in its order."""
    by_name = {
        name: variable
        for variable in part.variables
        for unit in (variable.unit,)
        # A name may be told as the file has it, with its unit.
        for name in (f"{variable.name} ({unit})", f"{variable.name} [{unit}]", variable.name)
    }
    found: dict[Role, list[Variable]] = {}
    for role, names in hints.variables.items():
        for name in names:
            if name not in by_name:
                raise ForeignFileError(
                    f"{part.origin}: variables.{role}: wanted the name of an array in the file, "
                    f"got {name[:60]!r}"
                )
            found.setdefault(Role(role), []).append(by_name[name])
    return found


def _only_rising(part: Variables, found: dict[Role, list[Variable]], axis: Role) -> None:
    """Take for signals what is named after an axis but does not rise, where another one does."""
    rising = [v for v in found.get(axis, ()) if _rises(v)]
    others = [v for v in found.get(axis, ()) if not _rises(v)]
    if rising and others:
        found[axis] = rising
        kept = [*found.get(Role.UNKNOWN, ()), *(v for v in others if v.values.size > 1)]
        # In the file's order, which tells a real part from an imaginary one.
        found[Role.UNKNOWN] = sorted(kept, key=part.variables.index)


def _rises(variable: Variable) -> bool:
    values = np.real(variable.values).reshape(-1)
    return len(values) > 1 and bool((np.diff(values) > 0).all())


def _is_frf(part: Variables, found: Found, hints: Hints) -> bool:
    if hints.kind is not None:
        return hints.kind == "frf"
    if has_frf(found):
        return True
    if found.get(Role.FREQUENCY) and not found.get(Role.TIME):
        raise ForeignFileError(
            f"{part.origin}: wanted complex FRFs over these frequencies, or real and imaginary "
            "part, or magnitude and phase, got none; export them, or say `variables` in the "
            "manifest"
        )
    return False


def _scalar(part: Variables, name: str) -> list[float]:
    told = part.texts.get(name, ("",))[0]
    if told.isdecimal():
        return [float(told)]
    for variable in part.variables:
        if variable.name == name and variable.values.size == 1 and not variable.is_complex:
            number = float(variable.values.reshape(-1)[0])
            if np.isfinite(number) and number >= 0.0:
                return [number]
    return []
