"""Sound files (WAV)."""

from armodal.protocols.foreign.file_format import FileFormat, of_bytes
from armodal.protocols.foreign.wav import wav_variables

__all__ = ["FORMAT"]

FORMAT = FileFormat(
    name="sound",
    holds=(
        "PCM of 8 to 32 bits and IEEE numbers; the first channel is the force unless another "
        "alone is one push, which is said, or `variables` says another; needs `scale`, per "
        "full scale"
    ),
    endings=(".wav",),
    is_it=lambda head: head.startswith(b"RIFF") and head[8:12] == b"WAVE",
    variables=of_bytes(wav_variables),
)
