"""The manifest of files that came without one, and what is in doubt."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.file_pairs import with_forces
from armodal.protocols.foreign.guess import Guess, guess_manifest
from armodal.protocols.foreign.inspection import inspect_file
from armodal.protocols.os_words import os_words

__all__ = ["guess_json", "is_manifest", "manifest_beside", "unanswered"]


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
    looked = [inspect_file(file, force=force) for file, force in with_forces(files)]
    guess = guess_manifest(looked, path.parent)
    if path.exists() and path.read_text(encoding="utf-8", errors="replace") != guess.text:
        raise ForeignFileError(
            f"{path}: wanted a place for a manifest, there is one; import that, or remove it"
        )
    try:
        path.write_bytes(guess.text.encode("utf-8"))
    except UnicodeEncodeError as error:
        raise ForeignFileError(
            "wanted names of files in UTF-8, which a manifest can hold; got one that is not; "
            "rename the file"
        ) from error
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
