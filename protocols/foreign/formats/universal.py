"""Universal files (UFF)."""

from armodal.protocols.foreign.file_format import FileFormat
from armodal.protocols.foreign.uff_measured import uff_content
from armodal.protocols.foreign.uff_read import uff_from_bytes
from armodal.protocols.foreign.uff_signals import uff_signals

__all__ = ["FORMAT"]


def _is_it(head: bytes) -> bool:
    first = next((line for line in head.splitlines() if line.strip()), b"")
    return first.rstrip() == b"    -1"


FORMAT = FileFormat(
    name="universal",
    holds=(
        "FRFs (type 4) with their coherence (6), or time records (1) of single hits: a force "
        "opens a hit, its accelerations follow; geometry"
    ),
    endings=(".uff", ".unv", ".uf", ".bunv", ".ufb", ".uff58"),
    is_it=_is_it,
    variables=lambda path, data: uff_signals(uff_from_bytes(data, path.name), path.name),
    own_read=lambda path, data, hints: uff_content(
        uff_from_bytes(data, path.name), hints, path.name
    ),
)
