"""One foreign file, read by what it holds: its first bytes tell its format, not its name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.hdf5_variables import hdf5_variables
from armodal.protocols.foreign.lvm import LVM_SIGN, lvm_variables
from armodal.protocols.foreign.mat import mat_variables
from armodal.protocols.foreign.meaning import content_of
from armodal.protocols.foreign.measured import Content, Hints
from armodal.protocols.foreign.numpy_files import npy_variables, npz_variables
from armodal.protocols.foreign.tdms import tdms_variables
from armodal.protocols.foreign.text_table import text_variables
from armodal.protocols.foreign.uff_blocks import read_foreign_bytes
from armodal.protocols.foreign.uff_measured import uff_content
from armodal.protocols.foreign.uff_read import uff_from_bytes
from armodal.protocols.foreign.variables import Variables
from armodal.protocols.foreign.wav import wav_variables
from armodal.protocols.session.hdf5 import DEFINITION
from armodal.protocols.session.journal_framing import MAGIC

__all__ = ["format_of", "read_content"]

_TEXT_LIMIT = 512 * 2**20
_HDF5_SIGN = b"\x89HDF\r\n\x1a\n"
_HEAD = 2048

_READERS: dict[str, Callable[[bytes, str], tuple[Variables, ...]]] = {
    "LabVIEW measurement": lvm_variables,
    "MATLAB": mat_variables,
    "NPY": npy_variables,
    "NPZ": npz_variables,
    "TDMS": tdms_variables,
    "sound": wav_variables,
    "text": text_variables,
}
_SIGNS = (
    ("HDF5", _HDF5_SIGN),
    ("NPY", b"\x93NUMPY"),
    ("NPZ", b"PK\x03\x04"),
    ("NPZ", b"PK\x05\x06"),
    ("TDMS", b"TDSm"),
    ("sound", b"RIFF"),
    ("LabVIEW measurement", LVM_SIGN.encode()),
)
# Formats that a damaged first byte would hide.
_ENDINGS = {
    ".mat": "MATLAB", ".npy": "NPY", ".npz": "NPZ", ".tdms": "TDMS", ".wav": "sound",
    ".lvm": "LabVIEW measurement", ".h5": "HDF5", ".hdf5": "HDF5", ".nc": "HDF5", ".nc4": "HDF5",
    ".uff": "universal", ".unv": "universal", ".uf": "universal", ".bunv": "universal",
    ".ufb": "universal", ".uff58": "universal",
}  # fmt: skip


def format_of(head: bytes, suffix: str) -> str:
    """Return a file's format by its first bytes, else by its ending, else text.

    >>> format_of(b"RIFF....WAVE", ".csv")
    'sound'
    """
    for name, sign in _SIGNS:
        if head.startswith(sign) and (name != "sound" or head[8:12] == b"WAVE"):
            return name
    # MATLAB 7.3 puts its own 512 bytes before HDF5's.
    if head[512:520] == _HDF5_SIGN:
        return "HDF5"
    if head[126:128] in {b"IM", b"MI"} and head[124:126] in {b"\x00\x01", b"\x01\x00"}:
        return "MATLAB"
    first = next((line for line in head.splitlines() if line.strip()), b"")
    if first.rstrip() == b"    -1":
        return "universal"
    return _ENDINGS.get(suffix.lower(), "text")


def read_content(path: Path, hints: Hints) -> Content:
    """Return the measurements in a file.

    Raises
    ------
    ForeignFileError
        If the file cannot be read, or is no measurement; the message ends with what was found.
    """
    data = read_foreign_bytes(path)
    name = format_of(data[:_HEAD], path.suffix)
    _refuse_own(data, name, path)
    if name == "universal":
        return uff_content(uff_from_bytes(data, path.name), hints, path.name)
    if name == "HDF5":
        return content_of(hdf5_variables(path), hints, path.name)
    if name == "text" and len(data) > _TEXT_LIMIT:
        raise ForeignFileError(
            f"{path.name}: wanted at most {_TEXT_LIMIT} bytes of text, got {len(data)}; export it "
            "in binary, or split it"
        )
    return content_of(_READERS[name](data, path.name), hints, path.name)


def _refuse_own(data: bytes, name: str, path: Path) -> None:
    """Say of a file of ours which command is for it."""
    if data.startswith(MAGIC[:-1]):
        raise ForeignFileError(
            f"{path.name}: wanted measurements of another program, got a journal of armodal; "
            f"`armodal recover {path}` makes a session of it"
        )
    if name == "HDF5" and DEFINITION.encode() in data:
        raise ForeignFileError(
            f"{path.name}: wanted measurements of another program, got a session of armodal; it "
            f"needs no import: `armodal review {path}`, `armodal fit {path}`"
        )
