"""One foreign file read by what its name ends in."""

from __future__ import annotations

from pathlib import Path

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.arrays_measured import array_content
from armodal.protocols.foreign.mat import mat_content
from armodal.protocols.foreign.measured import Content, Hints
from armodal.protocols.foreign.uff_measured import uff_content
from armodal.protocols.foreign.uff_read import read_uff

__all__ = ["read_content"]

_UFF = {".uff", ".unv", ".uf", ".bunv", ".ufb", ".uff58"}
_ARRAYS = {".npy", ".npz", ".csv", ".txt", ".dat", ".tsv", ".asc"}


def read_content(path: Path, hints: Hints) -> Content:
    """Return the measurements in a file.

    Raises
    ------
    ForeignFileError
        If the file cannot be read, or what kind it is cannot be told.
    """
    suffix = path.suffix.lower()
    if suffix in _UFF:
        return uff_content(read_uff(path), hints, path.name)
    if suffix in _ARRAYS:
        return array_content(path, hints)
    if suffix == ".mat":
        return mat_content(path, hints)
    raise ForeignFileError(
        f"{path.name}: wanted a file called .uff, .unv, .npy, .npz, .csv, .txt or .mat, got "
        f"{suffix or 'no ending'}; rename or convert it"
    )
