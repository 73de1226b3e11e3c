"""The table of messages: what it gives in Python, and what is made from it."""

import json
import re
from dataclasses import dataclass
from enum import IntEnum
from fractions import Fraction
from pathlib import Path
from typing import Annotated, ClassVar

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.any_record import records

from armodal.protocols.board import MESSAGES, FrameType, Header, ReplyCode
from armodal.protocols.board.fields import Rule, choice, constant, u8, u16
from armodal.protocols.board.generate.__main__ import main
from armodal.protocols.board.layout import decode, encode, layout_of
from armodal.protocols.errors import FrameError

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = (ROOT / "docs" / "board-protocol.md").read_text(encoding="utf-8")
VECTORS = json.loads(
    (ROOT / "tests" / "vectors" / "board-fields-v1.json").read_text(encoding="utf-8")
)
RECORDS = {kind.name: m.record for kind, m in MESSAGES.items() if m.record}
RECORDS["header"] = Header
ANSWERS = {kind.name for kind, m in MESSAGES.items() if m.is_answer}
RECORD = st.sampled_from(sorted(RECORDS))


def vectors(key):
    return pytest.mark.parametrize("vector", VECTORS[key], ids=lambda row: row["name"])


def table_of(name):
    """Rows of a table of the document: offset, size in bytes, whether signed, and name."""
    between = re.search(
        rf"<!-- {name}: made from the table .*?-->(.*?)<!-- end -->", DOCUMENT, re.DOTALL
    )
    for line in between[1].splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) > 2 and re.fullmatch(r"[ui](8|16|32|64)", cells[1]):
            yield int(cells[0]), int(cells[1][1:]) // 8, cells[1][0] == "i", cells[2]


def test_the_files_made_from_the_table_are_what_it_makes(capsys):
    assert main(["--check"]) == 0, capsys.readouterr().out


def test_every_frame_type_has_a_row_and_every_command_its_reply():
    assert set(MESSAGES) == set(FrameType)
    commands = [kind for kind in FrameType if kind < 0x80]
    assert {FrameType(kind + 0x80) for kind in commands} <= set(FrameType)


def test_the_reply_codes_of_the_document_are_those_of_the_code():
    rows = re.findall(r"^\| (\d) \| ([A-Z_]+) \|", DOCUMENT, re.MULTILINE)
    codes = [(int(number), name) for number, name in rows if name in ReplyCode.__members__]
    assert codes == [(int(code), code.name) for code in ReplyCode]


@vectors("records")
def test_an_extreme_of_a_field_stands_where_the_document_says(vector):
    data = bytes.fromhex(vector["bytes"])
    start = 2 if vector["record"] in ANSWERS else 0  # behind code and reason
    found, end = {}, start
    for offset, size, is_signed, name in table_of(vector["record"]):
        assert offset == end
        end += size
        piece = data[offset - start : end - start]
        found[name] = int.from_bytes(piece, "little", signed=is_signed)
    assert end - start == len(data)
    for name, value in vector["fields"].items():
        if isinstance(value, list):
            assert [found[f"{name}_numerator"], found[f"{name}_denominator"]] == value
        else:
            assert found[name] == int(value)


@vectors("records")
def test_an_extreme_of_a_field_is_read_and_written(vector):
    record, data = RECORDS[vector["record"]], bytes.fromhex(vector["bytes"])
    found = decode(record, data)
    assert encode(found) == data
    for name, value in vector["fields"].items():
        wanted = Fraction(*value) if isinstance(value, list) else int(value)
        assert getattr(found, name) == wanted


@vectors("invalid_records")
def test_what_is_outside_a_range_is_refused(vector):
    with pytest.raises(FrameError):
        decode(RECORDS[vector["record"]], bytes.fromhex(vector["bytes"]))


@given(RECORD.flatmap(lambda name: records(RECORDS[name])))
def test_any_record_survives(record):
    assert decode(type(record), encode(record)) == record


@given(RECORD, st.binary(max_size=40))
def test_any_bytes_are_a_record_or_raise_frame_error(name, data):
    try:
        found = decode(RECORDS[name], data)
    except FrameError:
        return
    size = layout_of(RECORDS[name]).size
    # Flags without a name are ignored, quotients are reduced; all else is kept to the bit.
    assert decode(RECORDS[name], encode(found)) == found
    assert len(data) == size


class Colour(IntEnum):
    RED = 0
    GREEN = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Lamp:
    colour: Annotated[Colour, choice("of the lamp")]
    zero: ClassVar[Annotated[int, constant("u8", 0, "")]]
    times: Annotated[int, u8("flashes", low=1, high=9)]
    pause: Annotated[int, u16("between them", unit="ms")]

    rules: ClassVar[tuple[Rule, ...]] = (
        Rule(words="no pause for one flash", holds=lambda m: m.times > 1 or not m.pause, c="1"),
    )


def test_all_broken_ranges_are_named_at_once():
    with pytest.raises(FrameError) as caught:
        decode(Lamp, bytes([2, 1, 0, 0, 0]), "LAMP")
    said = str(caught.value)
    assert said.startswith("LAMP: ")
    assert "colour 0 RED, 1 GREEN wanted, got 2" in said
    assert "zero 0 wanted, got 1" in said
    assert "times 1...9 wanted, got 0" in said


def test_a_rule_between_fields_is_told_in_its_words():
    with pytest.raises(FrameError, match="no pause for one flash; got Lamp"):
        decode(Lamp, bytes([0, 0, 1, 5, 0]))


def test_a_record_that_says_nothing_of_the_wire_has_no_layout():
    @dataclass
    class Plain:
        number: int

    with pytest.raises(TypeError, match="Plain"):
        layout_of(Plain)
