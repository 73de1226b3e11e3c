"""Text tables of any analyser: what no other format claims."""

from pathlib import Path

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.file_format import FileFormat, of_variables
from armodal.protocols.foreign.measured import Content, Hints
from armodal.protocols.foreign.text_table import text_variables

__all__ = ["FORMAT"]

_MOST_BYTES = 512 * 2**20

_read = of_variables(text_variables)


def _bounded(path: Path, data: bytes, hints: Hints) -> Content:
    if len(data) > _MOST_BYTES:
        raise ForeignFileError(
            f"{path.name}: wanted at most {_MOST_BYTES} bytes of text, got {len(data)}; export it "
            "in binary, or split it"
        )
    return _read(path, data, hints)


FORMAT = FileFormat(name="text", endings=(), is_it=lambda _: False, read=_bounded)
