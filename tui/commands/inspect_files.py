"""`armodal inspect`, and `armodal import` of files without a manifest."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.guess import Guess, guess_manifest
from armodal.protocols.foreign.looked_at import LookedAt, look_at
from armodal.protocols.os_words import os_words
from armodal.tui.console import Json, out, print_json, say, say_next

__all__ = ["app", "guess_json", "is_manifest", "manifest_beside", "unanswered"]

app = typer.Typer(add_completion=False)

_USER_ERROR = 2
_MOST_ROWS = 40


def is_manifest(files: Sequence[Path]) -> bool:
    """Return whether the argument of `armodal import` is a manifest."""
    return len(files) == 1 and files[0].suffix.lower() == ".toml"


def manifest_beside(files: Sequence[Path], output: Path) -> tuple[Path, Guess]:
    """Write the manifest guessed of files beside the output.

    Raises
    ------
    ForeignFileError
        If a file cannot be read, or another manifest is there already.
    """
    path = output.with_suffix(".toml")
    guess = guess_manifest([look_at(file) for file in files], path.parent)
    if path.exists() and path.read_text(encoding="utf-8", errors="replace") != guess.text:
        raise ForeignFileError(
            f"{path}: wanted a place for a manifest, there is one; import that, or remove it"
        )
    try:
        path.write_text(guess.text, encoding="utf-8")
    except OSError as error:
        raise ForeignFileError(
            f"{path}: cannot be written ({os_words(error)}); choose another place"
        ) from error
    return path, guess


def unanswered(path: Path, guess: Guess) -> ForeignFileError:
    """Return the error that says what to fill in."""
    first = guess.doubts[0]
    keys = ", ".join(f"`{key}`" for key in dict.fromkeys(doubt.key for doubt in guess.doubts))
    return ForeignFileError(
        f'wrote {path}: fill in {keys} where it says "?" ({first.why}), then import {path}'
    )


def guess_json(path: Path, guess: Guess) -> dict[str, Any]:
    """Return the guesses as plain values."""
    return {
        "manifest": str(path),
        "guesses": list(guess.guesses),
        "fill_in": [{"key": doubt.key, "why": doubt.why} for doubt in guess.doubts],
    }


@app.command("inspect")
def inspect_command(
    files: Annotated[list[Path], typer.Argument(help="Files of any measuring program.")],
    as_json: Json = False,
) -> None:
    """Show what files of other programs hold, and what their import manifest needs.

    Example: armodal inspect Hxysv00001.txt case2.mat
    """
    looked: list[LookedAt] = []
    errors: dict[str, str] = {}
    for path in files:
        say(f"reading {path}")
        try:
            looked.append(look_at(path))
        except ForeignFileError as error:
            errors[str(path)] = str(error)
    manifest, question = "", ""
    try:
        guess = guess_manifest(looked, Path.cwd()) if looked else None
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
    if errors:
        raise typer.Exit(_USER_ERROR)


def _file_json(looked: LookedAt) -> dict[str, Any]:
    content = looked.content
    return {
        "file": str(looked.path),
        "format": looked.format,
        "contents": [_row_json(row) for row in looked.found],
        "holds": _holds(looked),
        "said": [] if content is None else list(content.said),
        "needs": [{"key": doubt.key, "why": doubt.why} for doubt in looked.doubts],
    }


def _row_json(row: Any) -> dict[str, Any]:
    return {"name": row.name, "shape": list(row.shape), "type": row.type, "unit": row.unit or None}


def _holds(looked: LookedAt) -> str:
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


def _asks(looked: LookedAt, key: str) -> bool:
    return any(doubt.key == key for doubt in looked.doubts)


def _show(looked: LookedAt) -> None:
    out.print(f"{looked.path}: {looked.format}, {_holds(looked)}")
    content = looked.content
    for row in looked.found[:_MOST_ROWS]:
        out.print(f"  {row.words}")
    for text in () if content is None else content.said:
        out.print(f"  note: {text}")
    for doubt in looked.doubts:
        out.print(f"  needs `{doubt.key}`: {doubt.why}")


def _show_manifest(guess: Guess | None, question: str) -> None:
    if question:
        out.print(f"note: {question}")
    if guess is None:
        return
    for text in guess.guesses:
        out.print(f"guess: {text}")
    for doubt in guess.doubts:
        if doubt.key == "responses":
            out.print(f"needs `responses`: {doubt.why}")
    out.print("manifest:")
    out.print(guess.text.rstrip("\n"))


def _say_next(looked: list[LookedAt], guess: Guess | None) -> None:
    """Say how to import what was read; nothing where nothing could be."""
    if guess is None:
        return
    if guess.doubts:
        why = "with the manifest above kept as MANIFEST.toml, what it needs filled in"
        say_next("import MANIFEST.toml --out session.h5", why)
    else:
        names = " ".join(str(one.path) for one in looked)
        say_next(f"import {names} --out session.h5")
