"""Text tables of any analyser: what no other format claims."""

from collections.abc import Sequence
from pathlib import Path

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.file_format import FileFormat
from armodal.protocols.foreign.text_table import text_variables
from armodal.protocols.foreign.variables import Variables

__all__ = ["FORMAT"]

_MOST_BYTES = 512 * 2**20


def _bounded(path: Path, data: bytes) -> Sequence[Variables]:
    if len(data) > _MOST_BYTES:
        raise ForeignFileError(
            f"{path.name}: wanted at most {_MOST_BYTES} bytes of text, got {len(data)}; export it "
            "in binary, or split it"
        )
    return text_variables(data, path.name)


FORMAT = FileFormat(
    name="text",
    holds="a table, or one complex number a line",
    endings=(),
    is_it=lambda _: False,
    variables=_bounded,
)
