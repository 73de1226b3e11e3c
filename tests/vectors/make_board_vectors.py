"""Make `board-v1.json` and the worked example of `docs/board-protocol.md` from the code.

python tests/vectors/make_board_vectors.py           writes both
python tests/vectors/make_board_vectors.py --check   exit code 0 if both are up to date
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import asdict, fields
from fractions import Fraction
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from support import board_examples as examples
from support.board_examples import header_of
from support.board_troubles import invalid_frames, invalid_payloads, streams
from support.board_worked_example import worked_example

from armodal.protocols.board import (
    MESSAGES,
    Frame,
    FrameType,
    Overflow,
    ReplyCode,
    decode_answer,
    decode_frame,
    decode_payload,
    decode_reply,
    decode_samples,
    dictionary_hash,
    encode_dictionary,
    encode_frame,
    encode_reply,
    hello_fragments,
    pack_counts,
    refusal,
    sequence_gap,
)
from armodal.protocols.board.generate.vectors import valid_record
from armodal.protocols.board.layout import encode, layout_of

HERE = Path(__file__).resolve().parent
VECTORS = HERE / "board-v1.json"
DOCUMENT = HERE.parents[1] / "docs" / "board-protocol.md"
BEGIN = "<!-- worked example: made by tests/vectors/make_board_vectors.py -->\n"
END = "<!-- end of worked example -->\n"

WIDE = {"first_sample", "ticks", "next_sample", "stream_samples_dropped", "trigger_sample"}
WIDE |= {"trigger_ticks"}


def plain(value: Any, name: str = "") -> Any:
    """JSON form of a record's fields, of one field, or of a list."""
    if isinstance(value, dict):
        return {key: plain(item, key) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, Fraction):
        return [value.numerator, value.denominator]
    return str(value) if name in WIDE else value


def record(value: Any) -> Any:
    """JSON form of a dataclass."""
    return plain(asdict(value))


def fragment_fields(frame: Frame) -> dict[str, Any]:
    """Fields of HELLO_REPLY."""
    total, offset = (int.from_bytes(frame.payload[i : i + 2], "little") for i in (0, 2))
    return {"total": total, "offset": offset, "fragment": frame.payload[4:].hex()}


def sample_fields(frame: Frame) -> dict[str, Any]:
    """Fields of STREAM and BLOCK_DATA."""
    samples = decode_samples(frame)
    block = {} if samples.block_id is None else {"block_id": samples.block_id}
    return {**block, "counts": samples.counts.tolist()}


def reply_fields(frame: Frame) -> dict[str, Any]:
    """Fields of a reply, and of the record after it."""
    code, reason = decode_reply(frame.payload)
    carried = MESSAGES[frame.header.type].record
    body = record(decode_answer(carried, frame.payload)) if carried else {}
    return {"code": int(code), "reason": reason, **body}


def payload_fields(frame: Frame) -> dict[str, Any]:
    """The fields a payload decodes to, by the names of the document."""
    message = MESSAGES[frame.header.type]
    if frame.header.type is FrameType.HELLO_REPLY:
        return fragment_fields(frame)
    if frame.header.type in (FrameType.STREAM, FrameType.BLOCK_DATA):
        return sample_fields(frame)
    if message.is_answer:
        return reply_fields(frame)
    return record(decode_payload(message.record, frame.payload)) if message.record else {}


def without_example() -> Iterator[tuple[str, FrameType, bytes, int, Overflow]]:
    """A message of each type that has no example of its own, by the table alone."""
    there = {kind for _, kind, *_ in examples.MESSAGES}
    for kind in sorted(set(FrameType) - there):
        message = MESSAGES[kind]
        head = encode_reply(ReplyCode.OK) if message.is_answer else b""
        body = encode(valid_record(layout_of(message.record))) if message.record else b""
        yield kind.name.lower().replace("_", " "), kind, head + body, 0, Overflow.NONE


def frame_vectors() -> list[dict[str, Any]]:
    """One valid frame of every type and more."""
    vectors = []
    messages = (*examples.MESSAGES, *without_example())
    for index, (name, kind, payload, first, overflow) in enumerate(messages):
        header = header_of(index, kind, first, overflow)
        wire = encode_frame(header, payload)
        names = [field.name for field in fields(header) if field.name != "type"]
        vectors.append(
            {
                "name": name,
                "type": kind.name,
                "header": plain({field: getattr(header, field) for field in names}),
                "fields": payload_fields(decode_frame(wire[1:-1])),
                "payload": payload.hex(),
                "wire": wire.hex(),
            }
        )
    return vectors


def limit_vectors() -> list[dict[str, Any]]:
    """Configurations, accepted and refused."""
    cases = [("two channels", name, c) for name, c in examples.CONFIGURATIONS.items()]
    cases.append(
        ("slow link", "block takes too long", examples.CONFIGURATIONS["fast without stream"])
    )
    boards = {"two channels": examples.TWO_CHANNELS, "slow link": examples.SLOW_LINK}
    vectors = []
    for board, name, configuration in cases:
        code, reason = refusal(configuration, boards[board]) or (ReplyCode.OK, "")
        vectors.append(
            {
                "name": name,
                "dictionary": board,
                "configuration": record(configuration),
                "code": int(code),
                "reason": reason,
            }
        )
    return vectors


def build() -> dict[str, Any]:
    """Return the whole vector file as one object."""
    dictionaries = {**examples.DICTIONARIES, "slow link": examples.SLOW_LINK}
    gaps = [(7, 7), (7, 9), (9, 7), (0, 0xFFFFFFFF), (0xFFFFFFFF, 1), (0, 0x7FFFFFFF)]
    gaps.append((0, 0x80000000))
    encoded = {name: encode_dictionary(value) for name, value in dictionaries.items()}
    return {
        "protocol": "armodal board",
        "version": 1,
        "frames": frame_vectors(),
        "invalid_frames": invalid_frames(),
        "invalid_payloads": invalid_payloads(),
        "streams": streams(),
        "dictionaries": [
            {
                "name": name,
                "fields": record(value),
                "encoded": encoded[name].hex(),
                "hash": dictionary_hash(encoded[name]),
                "fragments": plain(hello_fragments(encoded[name])),
            }
            for name, value in dictionaries.items()
        ],
        "samples": [
            {"name": name, "counts": counts.tolist(), "encoded": pack_counts(counts).hex()}
            for name, counts in examples.COUNTS.items()
        ],
        "sequences": [
            {"expected": expected, "sequence": sequence, "gap": sequence_gap(expected, sequence)}
            for expected, sequence in gaps
        ],
        "limits": limit_vectors(),
    }


def render(vectors: dict[str, Any]) -> str:
    """JSON with one vector a line."""
    lines = []
    for key, value in vectors.items():
        if isinstance(value, list):
            rows = ",\n".join("  " + json.dumps(row, ensure_ascii=False) for row in value)
            lines.append(f" {json.dumps(key)}: [\n{rows}\n ]")
        else:
            lines.append(f" {json.dumps(key)}: {json.dumps(value)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def document_with_example(document: str) -> str:
    """Put the worked example into the document, between its markers."""
    before, rest = document.split(BEGIN)
    _, after = rest.split(END)
    return before + BEGIN + worked_example() + END + after


def main(arguments: list[str]) -> int:
    """Write both files, or with `--check` tell whether they are as the code makes them."""
    document = DOCUMENT.read_text(encoding="utf-8")
    wanted = {VECTORS: render(build()), DOCUMENT: document_with_example(document)}
    if arguments == ["--check"]:
        stale = [p.name for p, text in wanted.items() if p.read_text(encoding="utf-8") != text]
        sys.stdout.write("".join(f"{name} is not what the code makes\n" for name in stale))
        return len(stale)
    for path, text in wanted.items():
        path.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
