"""Sound files (WAV)."""

from armodal.protocols.foreign.file_format import FileFormat, of_bytes
from armodal.protocols.foreign.wav import wav_variables

__all__ = ["FORMAT"]

FORMAT = FileFormat(
    name="sound",
    endings=(".wav",),
    is_it=lambda head: head.startswith(b"RIFF") and head[8:12] == b"WAVE",
    variables=of_bytes(wav_variables),
)
