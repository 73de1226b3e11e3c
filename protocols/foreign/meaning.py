"""What named arrays mean: FRFs or a hit, by their names and units, their numbers, the manifest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.by_numbers import parts_by_numbers, roles_by_numbers
from armodal.protocols.foreign.complex_arrays import has_frf
from armodal.protocols.foreign.even import is_even
from armodal.protocols.foreign.frf_variables import Words, frfs_of
from armodal.protocols.foreign.hit_variables import hit_of
from armodal.protocols.foreign.measured import Content, ForeignFrf, ForeignHit, Hints, NotToldError
from armodal.protocols.foreign.roles import Role, role_of
from armodal.protocols.foreign.variables import Variable, Variables, listing, one_line

__all__ = ["content_of"]

Found = Mapping[Role, Sequence[Variable]]


def content_of(parts: Sequence[Variables], hints: Hints, origin: str) -> Content:
    """Return the FRFs and hits in the sections of a file.

    Raises
    ------
    ForeignFileError
        If they are none; the message ends with what was found.
    """
    words = Words([], [])
    frfs: list[ForeignFrf] = []
    hits: list[ForeignHit] = []
    listed = tuple(one for part in parts for one in part.listed)
    averages: list[float] = []
    decays: list[float] = []
    try:
        for part in parts:
            words.said += part.said
            found = _found(part, hints, words)
            if _is_frf(part, found, hints):
                frfs += frfs_of(part, found, hints, words)
            else:
                hits.append(hit_of(part, found, hints, words.said))
            averages += _scalar(part, "averages")
            decays += _scalar(part, "window_decay_rad_s")
    except NotToldError as error:
        raise NotToldError(one_line(error.why), key=error.key, listed=listed) from error
    except ForeignFileError as error:
        raise ForeignFileError(f"{one_line(str(error))}; {listing(listed)}") from error
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
        _only_rising(found, axis)
    _first_column(part, found)
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


def _mapped(part: Variables, hints: Hints) -> Found:
    """Return the arrays that the manifest names, in its order."""
    by_name = {variable.name: variable for variable in part.variables}
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


def _only_rising(found: dict[Role, list[Variable]], axis: Role) -> None:
    """Take for signals what is named after an axis but does not rise, where another one does."""
    rising = [v for v in found.get(axis, ()) if _rises(v)]
    others = [v for v in found.get(axis, ()) if not _rises(v)]
    if rising and others:
        found[axis] = rising
        found.setdefault(Role.UNKNOWN, []).extend(v for v in others if v.values.size > 1)


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
    for variable in part.variables:
        if variable.name == name and variable.values.size == 1 and not variable.is_complex:
            number = float(variable.values.reshape(-1)[0])
            if np.isfinite(number) and number >= 0.0:
                return [number]
    return []
