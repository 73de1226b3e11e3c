"""A foreign file looked at without a manifest: what it holds, what is guessed, what is in doubt."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from armodal.protocols.foreign.content import format_of, read_content
from armodal.protocols.foreign.file_format import HEAD_BYTES
from armodal.protocols.foreign.manifest import FILL_IN
from armodal.protocols.foreign.measured import Content, Hints, NotToldError, parse_dof
from armodal.protocols.foreign.variables import Listed
from armodal.protocols.frf_records import FrfForm

__all__ = ["Doubt", "Inspection", "inspect_file"]

_MOST_QUESTIONS = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Doubt:
    """What only a person can say: the manifest's key, and why it is asked."""

    key: str
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Inspection:
    """One file; `keys` are what the manifest says about it."""

    path: Path
    format: str
    force: Path | None = None  # file of the force, where that is another one
    content: Content | None  # None where it cannot be read before a doubt is settled
    found: tuple[Listed, ...] = ()
    keys: Mapping[str, Any] = field(default_factory=dict)
    guesses: tuple[str, ...] = ()
    doubts: tuple[Doubt, ...] = ()


def inspect_file(path: Path, *, kind: str | None = None, force: Path | None = None) -> Inspection:
    """Read a file with nothing told about it, guessing what can be guessed.

    Parameters
    ----------
    path
        The file.
    kind
        "frf" or "hit", where those beside it tell.
    force
        File of the force, where that is another one.

    Raises
    ------
    ForeignFileError
        If it cannot be read, whatever a manifest might say.
    """
    hints = Hints(kind=kind, force_file=force)
    keys: dict[str, Any] = {} if kind is None else {"kind": kind}
    guesses: list[str] = []
    doubts: list[Doubt] = []
    content: Content | None = None
    found: tuple[Listed, ...] = ()
    for _ in range(_MOST_QUESTIONS):
        try:
            content = read_content(path, hints)
        except NotToldError as error:
            found = error.listed
            answered = _answer(error, hints, keys, guesses, doubts)
            if answered is None:
                break
            hints = answered
        else:
            found = content.found
            break
    with path.open("rb") as file:
        name = format_of(file.read(HEAD_BYTES), path.suffix).name
    return Inspection(
        path=path,
        format=name,
        force=force,
        content=content,
        found=found,
        keys=keys,
        guesses=(*guesses, *(() if content is None else content.read_as)),
        doubts=tuple(doubts),
    )


def _answer(
    error: NotToldError,
    hints: Hints,
    keys: dict[str, Any],
    guesses: list[str],
    doubts: list[Doubt],
) -> Hints | None:
    """Note what a file leaves open and return hints to read on with; None where none would do."""
    key, _, count = error.key.partition(" ")
    if key == "responses":
        keys[key] = [str(i + 1) for i in range(int(count))]
        guesses.append(f"the {count} FRFs are points 1 to {count} in their order")
        dofs = tuple(parse_dof(name, key) for name in keys[key])
        return replace(hints, responses=dofs)
    doubts.append(Doubt(key=key, why=error.why))
    keys[key] = FILL_IN
    if key == "references":
        keys[key] = [FILL_IN] * int(count)
        dofs = tuple(parse_dof(f"reference {i + 1}", key) for i in range(int(count)))
        return replace(hints, references=dofs)
    if key in {"scale", "variables"}:
        keys[key] = {"force": FILL_IN, "response": FILL_IN}
    going_on: dict[str, dict[str, Any]] = {
        "form": {"form": FrfForm.ACCELERANCE},
        "line_spacing_hz": {"line_spacing_hz": 1.0},
        "rate_hz": {"rate_hz": 1000.0},
        "scale": {"force_scale": 1.0, "response_scale": 1.0},
    }
    return replace(hints, **going_on[key]) if key in going_on else None
