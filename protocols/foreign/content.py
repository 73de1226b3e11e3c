"""One foreign file, read by what it holds: its first bytes tell its format, not its name."""

from __future__ import annotations

from pathlib import Path

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.file_format import HEAD_BYTES, FileFormat, every_format
from armodal.protocols.foreign.measured import Content, Hints
from armodal.protocols.foreign.two_files import content_of_two
from armodal.protocols.foreign.uff_blocks import read_foreign_bytes
from armodal.protocols.session.hdf5 import DEFINITION
from armodal.protocols.session.journal_framing import MAGIC

__all__ = ["format_of", "read_content"]


def format_of(head: bytes, suffix: str) -> FileFormat:
    """Return a file's format by its first bytes, else by its ending, else text.

    >>> format_of(b"RIFF....WAVE", ".csv").name
    'sound'
    """
    known = {own.name: own for own in every_format()}
    by_head = (own for own in known.values() if own.is_it(head))
    by_ending = (own for own in known.values() if suffix.lower() in own.endings)
    return next(by_head, None) or next(by_ending, known["text"])


def read_content(path: Path, hints: Hints) -> Content:
    """Return the measurements in a file.

    Raises
    ------
    ForeignFileError
        If the file cannot be read, or is no measurement; the message ends with what was found.
    """
    own, data = _opened(path)
    if hints.force_file is None:
        return own.read(path, data, hints)
    responses = own.variables(path, data)
    own, data = _opened(hints.force_file)
    return content_of_two(own.variables(hints.force_file, data), responses, hints)


def _opened(path: Path) -> tuple[FileFormat, bytes]:
    """Return a file's format and all its bytes."""
    data = read_foreign_bytes(path)
    own = format_of(data[:HEAD_BYTES], path.suffix)
    _refuse_own(data, own, path)
    return own, data


def _refuse_own(data: bytes, own: FileFormat, path: Path) -> None:
    """Say of a file of ours which command is for it."""
    if data.startswith(MAGIC[:-1]):
        raise ForeignFileError(
            f"{path.name}: wanted measurements of another program, got a journal of armodal; "
            f"`armodal recover {path}` makes a session of it"
        )
    if own.name == "HDF5" and DEFINITION.encode() in data:
        raise ForeignFileError(
            f"{path.name}: wanted measurements of another program, got a session of armodal; it "
            f"needs no import: `armodal review {path}`, `armodal fit {path}`"
        )
