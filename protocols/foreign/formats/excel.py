"""Workbooks of spreadsheet programs: recognised, and refused with what to do."""

from collections.abc import Sequence
from pathlib import Path

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.file_format import FileFormat
from armodal.protocols.foreign.variables import Variables

__all__ = ["FORMAT", "is_workbook"]

_OLD = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"  # compound file, [MS-CFB] 2.2
_INSIDE = (b"[Content_Types].xml", b"xl/", b"mimetypeapplication/vnd.oasis.opendocument")


def is_workbook(head: bytes) -> bool:
    """Whether a file begins as .xls, .xlsx or .ods do."""
    return head.startswith(_OLD) or (
        head.startswith(b"PK\x03\x04") and any(name in head for name in _INSIDE)
    )


def _refused(path: Path, _data: bytes) -> Sequence[Variables]:
    raise ForeignFileError(
        f"{path.name}: wanted a table as text, got the workbook of a spreadsheet program; save "
        "the sheet that holds the numbers as CSV"
    )


FORMAT = FileFormat(
    name="spreadsheet workbook",
    holds="not read: save the sheet as CSV",
    endings=(),
    is_it=is_workbook,
    variables=_refused,
)
