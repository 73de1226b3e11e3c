"""The worked example of `docs/board-protocol.md`: one frame, byte by byte."""

from __future__ import annotations

import zlib

from cobs import cobs
from support import board_examples as examples

from armodal.protocols.board import (
    FrameType,
    Header,
    Overflow,
    Samples,
    dictionary_hash,
    encode_dictionary,
    encode_frame,
    encode_samples,
)


def spaced(data: bytes) -> str:
    """Hex bytes with spaces."""
    return data.hex(" ")


def worked_example() -> str:
    """Markdown of one STREAM frame, byte by byte, before and after COBS."""
    samples = Samples(first_sample=4096, counts=examples.SMALL_COUNTS)
    header = Header(
        type=FrameType.STREAM,
        session=examples.SESSION,
        sequence=258,
        dictionary_hash=dictionary_hash(encode_dictionary(examples.TWO_CHANNELS)),
        overflow=Overflow.STREAM,
        first_sample=samples.first_sample,
        ticks=24_804_096,
    )
    wire = encode_frame(header, encode_samples(samples))
    body = bytes(cobs.decode(wire[1:-1]))
    rows = [
        (1, "version 1"),
        (1, "type STREAM"),
        (2, f"dictionary_hash {header.dictionary_hash:04x}"),
        (4, f"session {header.session:08x}"),
        (4, f"sequence {header.sequence}"),
        (2, "overflow: STREAM"),
        (2, "tag 0"),
        (8, f"first_sample {header.first_sample}"),
        (8, f"ticks {header.ticks}"),
        (2, "2 samples"),
        (1, "2 channels"),
        (1, "3 bytes per count"),
    ]
    n_channels = samples.counts.shape[1]
    rows += [
        (3, f"sample {4096 + i // n_channels}, channel {i % n_channels}: {count}")
        for i, count in enumerate(samples.counts.ravel().tolist())
    ]
    rows.append((4, f"CRC-32 {zlib.crc32(body[:-4]):08x} of the {len(body) - 4} bytes above"))
    lines = [
        "",
        "The board (dictionary `two channels` of the vectors) sends two samples of two channels.",
        f"Header, payload and CRC-32 are {len(body)} bytes:",
        "",
        "| offset | bytes | meaning |",
        "|---|---|---|",
    ]
    offset = 0
    for size, meaning in rows:
        lines.append(f"| {offset} | `{spaced(body[offset : offset + size])}` | {meaning} |")
        offset += size
    if offset != len(body):
        raise ValueError(f"the table describes {offset} of {len(body)} bytes")
    lines += [
        "",
        "COBS cuts them at the zero bytes. Each row is a code byte and the bytes it announces;",
        "every row but the last (and but those with the code `ff`, of which there is none here)",
        "stands for one more zero byte at its end:",
        "",
        "| code | bytes | stands for |",
        "|---|---|---|",
    ]
    at, encoded, out = 0, wire[1:-1], 0
    while at < len(encoded):
        code = encoded[at]
        piece = encoded[at + 1 : at + code]
        at += code
        size = len(piece) + (at < len(encoded))
        shown = f"`{spaced(piece)}`" if piece else "none"
        span = f"byte {out}" if size == 1 else f"bytes {out}...{out + size - 1}"
        lines.append(f"| `{code:02x}` | {shown} | {span} |")
        out += size
    lines += ["", f"On the wire, with both delimiters, {len(wire)} bytes:", ""]
    lines += [f"    {spaced(wire[i : i + 16])}" for i in range(0, len(wire), 16)]
    return "\n".join(lines) + "\n\n"
