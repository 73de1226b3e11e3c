"""`armodal inspect`: what files of other programs hold."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.file_pairs import with_forces
from armodal.protocols.foreign.files_in import files_in
from armodal.protocols.foreign.guess import Guess, guess_manifest
from armodal.protocols.foreign.inspection import Inspection, inspect_file
from armodal.tui.command_parts.guessed_manifest import guess_json
from armodal.tui.console import Json, out, print_json, print_note, say, say_next

__all__ = ["app"]

app = typer.Typer(add_completion=False)

_USER_ERROR = 2
_MOST_ROWS = 40


@app.command("inspect")
def inspect_command(
    files: Annotated[
        list[Path], typer.Argument(help="Files of any measuring program, or a folder of them.")
    ],
    as_json: Json = False,
) -> None:
    """Show what files of other programs hold, and what their import manifest needs.

    Example: armodal inspect Hxysv00001.txt case2.mat
    """
    looked: list[Inspection] = []
    errors: dict[str, str] = {}
    for path, force in with_forces(files_in(files)):
        say(f"reading {path}" if force is None else f"reading {path} with {force}")
        try:
            looked.append(inspect_file(path, force=force))
        except ForeignFileError as error:
            errors[str(path)] = str(error)
    manifest, question = "", ""
    measured = any(_is_measured(one) for one in looked)
    try:
        guess = guess_manifest(looked, Path.cwd()) if measured else None
        manifest = "" if guess is None else guess.text
    except ForeignFileError as error:
        guess, question = None, str(error)
    if as_json:
        print_json(
            {
                "files": [_file_json(one) for one in looked],
                "refused": [{"file": path, "why": why} for path, why in errors.items()],
                "guesses": [] if guess is None else list(guess.guesses),
                "fill_in": [] if guess is None else guess_json(Path(), guess)["fill_in"],
                "manifest": manifest or None,
                "note": question or None,
            }
        )
    else:
        for one in looked:
            _show(one)
        for why in errors.values():
            out.print(f"refused: {why}")
        _show_manifest(guess, question)
        _say_next(looked, guess)
        if looked and not measured:
            say("next: export FRFs or hits too: points and shapes alone are nothing to import")
    if errors:
        raise typer.Exit(_USER_ERROR)


def _file_json(looked: Inspection) -> dict[str, Any]:
    content = looked.content
    return {
        "file": str(looked.path),
        "force": None if looked.force is None else str(looked.force),
        "format": looked.format,
        "contents": [_row_json(row) for row in looked.found],
        "holds": _holds(looked),
        "said": [] if content is None else list(content.said),
        "needs": [{"key": doubt.key, "why": doubt.why} for doubt in looked.doubts],
    }


def _row_json(row: Any) -> dict[str, Any]:
    return {"name": row.name, "shape": list(row.shape), "type": row.type, "unit": row.unit or None}


def _holds(looked: Inspection) -> str:
    """Return what a file holds in a few words."""
    content = looked.content
    if content is None:
        return "not known yet"
    if content.frfs:
        first = content.frfs[0]
        told = {doubt.key for doubt in looked.doubts}
        form = "FRF of unknown form" if "form" in told else str(first.form)
        band = f"{first.freq_hz[0]:g} to {first.freq_hz[-1]:g} Hz"
        lines = f"{len(first.freq_hz)} lines"
        where = lines if "line_spacing_hz" in told else f"{lines}, {band}"
        coherence = ", with coherence" if first.coherence is not None else ""
        return f"{len(content.frfs)} x {form}, {where}{coherence}"
    if content.hits:
        hit = content.hits[0]
        rate = "unknown rate" if _asks(looked, "rate_hz") else f"{float(hit.rate_hz):g} Hz"
        return (
            f"{len(content.hits)} hits, {len(hit.responses)} accelerations of {len(hit.force_n)} "
            f"samples at {rate}"
        )
    return "no FRF and no hit"


def _is_measured(looked: Inspection) -> bool:
    """Whether a file may hold FRFs or hits: geometry and shapes alone are nothing to import."""
    content = looked.content
    return content is None or bool(content.frfs or content.hits)


def _asks(looked: Inspection, key: str) -> bool:
    return any(doubt.key == key for doubt in looked.doubts)


def _show(looked: Inspection) -> None:
    force = "" if looked.force is None else f" with {looked.force}"
    out.print(f"{looked.path}{force}: {looked.format}, {_holds(looked)}")
    content = looked.content
    for row in looked.found[:_MOST_ROWS]:
        out.print(f"  {row.words}")
    for text in () if content is None else content.said:
        out.print(f"  note: {text}")
    for doubt in looked.doubts:
        out.print(f"  needs `{doubt.key}`: {doubt.why}")


def _show_manifest(guess: Guess | None, question: str) -> None:
    if question:
        print_note(question)
    if guess is None:
        return
    for text in guess.guesses:
        out.print(f"guess: {text}")
    for doubt in guess.doubts:
        if doubt.key == "responses":
            out.print(f"needs `responses`: {doubt.why}")
    out.print("manifest:")
    out.print(guess.text.rstrip("\n"))


def _say_next(looked: list[Inspection], guess: Guess | None) -> None:
    """Say how to import what was read; nothing where nothing could be."""
    if guess is None:
        return
    if guess.doubts:
        why = "with the manifest above kept as MANIFEST.toml, what it needs filled in"
        say_next("import MANIFEST.toml --out session.h5", why)
    else:
        names = " ".join(shlex.quote(str(one.path)) for one in looked)
        say_next(f"import {names} --out session.h5")
