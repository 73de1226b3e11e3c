"""Which file is the force of which, by their names."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.inspection import inspect_file
from armodal.protocols.foreign.roles import Role, role_of

__all__ = ["with_forces"]

_WORD = re.compile(r"[^\W\d_]+|\d+")


def with_forces(files: Sequence[Path]) -> list[tuple[Path, Path | None]]:
    """Return each file with the file of its force, where names tell that there is one.

    `hit1_force.wav` belongs to `hit1_acc.wav`: one word of a name is the signal. What else is in
    the force's name is how the response's begins, so that `force.txt` belongs to every response. A
    file that can be read by itself is no half of a pair.
    """
    roles = {file: _role(file) for file in files}
    responses = {file for file in files if roles[file] is Role.RESPONSE}
    forces = {
        _rest(file): file
        for file in files
        if responses and roles[file] is Role.FORCE and not _whole(file)
    }
    found = [(file, _force_of(file, forces) if file in responses else None) for file in files]
    used = {force for _, force in found}
    return [(file, force) for file, force in found if file not in used]


def _force_of(file: Path, forces: Mapping[tuple[str, ...], Path]) -> Path | None:
    """The force whose name has most in common with a response's."""
    rest = _rest(file)
    alike = [other for other in forces if rest[: len(other)] == other]
    if not alike or _whole(file, named=True):
        return None
    return forces[max(alike, key=len)]


def _role(file: Path) -> Role:
    """Force or response if exactly one word of a name says so."""
    told = [role for role in map(_word_role, _words(file)) if role is not Role.UNKNOWN]
    return told[0] if len(told) == 1 else Role.UNKNOWN


def _word_role(word: str) -> Role:
    role = role_of(word, "", is_complex=False) if len(word) > 1 else Role.UNKNOWN
    return role if role in {Role.FORCE, Role.RESPONSE} else Role.UNKNOWN


def _rest(file: Path) -> tuple[str, ...]:
    words = (word for word in _words(file) if _word_role(word) is Role.UNKNOWN)
    return (str(file.parent), *words)


def _words(file: Path) -> list[str]:
    return [word.lower() for word in _WORD.findall(file.stem)]


def _whole(file: Path, *, named: bool = False) -> bool:
    """Whether a file has FRFs, or force and responses itself, the force by its name if `named`."""
    try:
        looked = inspect_file(file)
    except ForeignFileError:
        return False
    if looked.content is None:
        return False
    roles = {role_of(one.name, one.unit, is_complex=False) for one in looked.found}
    is_hit = bool(looked.content.hits) and (not named or Role.FORCE in roles)
    return bool(looked.content.frfs) or is_hit
