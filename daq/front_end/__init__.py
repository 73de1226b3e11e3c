"""Front ends that are no board of ours: files, sound cards, NI; each becomes a board."""

from armodal.daq.front_end.board import FrontEndPort
from armodal.daq.front_end.opening import is_front_end, open_front_end, open_source
from armodal.daq.front_end.source import Chunk, SampleSource

__all__ = [
    "Chunk",
    "FrontEndPort",
    "SampleSource",
    "is_front_end",
    "open_front_end",
    "open_source",
]
