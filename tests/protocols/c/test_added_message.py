"""A message that is added to the table reaches Python, C, the document and the vectors."""

import json
import shutil
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Annotated, ClassVar

import pytest
from cffi import FFI
from hypothesis import given
from support.any_record import records

from armodal.protocols.board import FrameType, Message
from armodal.protocols.board.fields import Rule, choice, constant, flag, i32, u8, u64
from armodal.protocols.board.generate import (
    TABLE,
    Table,
    c_board_source,
    c_header,
    c_host_source,
    document_with_tables,
    field_vectors,
)
from armodal.protocols.board.layout import decode, encode
from armodal.protocols.c.build import INCLUDE, SOURCES, STRICT, compile_with, compilers
from armodal.protocols.c.library import declarations
from armodal.protocols.errors import FrameError

DOCUMENT = Path(__file__).resolve().parents[3] / "docs" / "board-protocol.md"
MARKERS = "<!-- IDENTIFY: made from the table of messages -->\n<!-- end -->\n"


class Lamp(IntEnum):
    GREEN = 0
    RED = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Identify:
    """What a board does that a person looks for among several."""

    lamp: Annotated[Lamp, choice("which lamp blinks")]
    again: Annotated[bool, flag("until STOP")]
    reserved: ClassVar[Annotated[int, constant("u8", 7, "")]]
    times: Annotated[int, u8("flashes", low=2, high=20)]
    offset: Annotated[int, i32("of the brightness", low=-5, unit="counts")]
    token: Annotated[int, u64("echoed to nobody")]

    rules: ClassVar[tuple[Rule, ...]] = (
        Rule(
            words="a red lamp flashes at most ten times",
            holds=lambda m: m.lamp == Lamp.GREEN or m.times <= 10,
            c="(m->lamp == AB_LAMP_GREEN || m->times <= 10)",
        ),
    )


NUMBERS = {kind.name: int(kind) for kind in FrameType} | {"IDENTIFY": 0x78, "IDENTIFY_REPLY": 0xF8}
ADDED = Table(
    types=IntEnum("FrameType", NUMBERS),
    messages={
        **TABLE.messages,
        0x78: Message(section=8, record=Identify),
        0xF8: Message(is_answer=True),
    },
)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """The whole device library with the message in it."""
    folder = tmp_path_factory.mktemp("added")
    shutil.copytree(INCLUDE, folder / "include")
    shutil.copytree(SOURCES[0].parent, folder / "src")
    made = {
        folder / "include" / "armodal_messages.h": c_header(ADDED),
        folder / "src" / "messages.c": c_board_source(ADDED),
        folder / "src" / "host_messages.c": c_host_source(ADDED),
    }
    for path, text in made.items():
        path.write_text(text, encoding="utf-8")
    sources = map(str, sorted((folder / "src").glob("*.c")))
    options = [*STRICT, "-fPIC", "-shared", f"-I{folder / 'include'}"]
    program = folder / "board.so"
    assert compile_with(next(compilers()), [*options, *sources], program) == ""
    ffi = FFI()
    for name in ("messages", "board", "host"):
        ffi.cdef(declarations(folder / "include" / f"armodal_{name}.h"))
    return ffi, ffi.dlopen(str(program))


def read(library, data):
    ffi, c = library
    found = ffi.new("ab_identify *")
    return found if c.ab_read_identify(data, len(data), found) else None


@given(wanted=records(Identify))
def test_it_passes_from_python_to_c_and_back(library, wanted):
    ffi, c = library
    found = read(library, encode(wanted))
    assert (found.lamp, found.again, found.times) == (wanted.lamp, wanted.again, wanted.times)
    assert (found.offset, found.token) == (wanted.offset, wanted.token)
    to = ffi.new("uint8_t[]", int(c.AB_IDENTIFY_BYTES))
    c.ab_write_identify(to, found)
    assert decode(Identify, bytes(ffi.buffer(to))) == wanted


def test_both_sides_agree_with_its_vectors(library):
    vectors = json.loads(field_vectors(ADDED))
    valid = [row for row in vectors["records"] if row["record"] == "IDENTIFY"]
    invalid = [row for row in vectors["invalid_records"] if row["record"] == "IDENTIFY"]
    reasons = " ".join(row["reason"] for row in invalid)
    for end in ("times 1", "times 21", "lamp 2", "again 2", "reserved 6", "offset -6"):
        assert end in reasons
    assert len(valid) == 10
    for row in valid:
        assert read(library, bytes.fromhex(row["bytes"])) is not None
        decode(Identify, bytes.fromhex(row["bytes"]))
    for row in invalid:
        assert read(library, bytes.fromhex(row["bytes"])) is None
        with pytest.raises(FrameError):
            decode(Identify, bytes.fromhex(row["bytes"]))


def test_c_judges_its_payload_by_type(library):
    _, c = library
    good = encode(Identify(lamp=Lamp.RED, again=True, times=10, offset=0, token=1))
    assert c.ab_payload_valid(c.AB_IDENTIFY, good, len(good))
    assert not c.ab_payload_valid(c.AB_IDENTIFY, good, len(good) - 1)
    assert c.ab_payload_valid(c.AB_IDENTIFY | c.AB_REPLY, b"\0\0", 2)


def test_c_knows_the_types_of_the_table_and_no_others(library):
    _, c = library
    assert {kind for kind in range(256) if c.ab_type_known(kind)} == {int(t) for t in ADDED.types}


def test_a_rule_between_its_fields_binds_both_sides(library):
    broken = encode(Identify(lamp=Lamp.RED, again=True, times=11, offset=0, token=1))
    assert read(library, broken) is None
    with pytest.raises(FrameError, match="at most ten times"):
        decode(Identify, broken)


def test_the_document_gets_its_table_at_the_end_of_its_section():
    made = document_with_tables(DOCUMENT.read_text(encoding="utf-8"), ADDED)
    assert "| `78` | IDENTIFY | host | 16 bytes, section 8 |" in made
    section = made[made.index("\n## 8.") : made.index("\n## 9.")]
    assert "### IDENTIFY\n\nWhat a board does that a person looks for among several.\n" in section
    assert "| 4 | i32 | offset | counts | of the brightness; -5 or more |" in section
    assert document_with_tables(made, ADDED) == made


def test_a_marker_that_names_nothing_is_refused():
    document = DOCUMENT.read_text(encoding="utf-8")
    with pytest.raises(ValueError, match="IDENTIFY"):
        document_with_tables(document + MARKERS, TABLE)


def test_a_longer_command_asks_for_a_larger_receive_buffer(library):
    _, c = library
    assert TABLE.longest_command - 2 == c.AB_RECEIVE_BYTES

    @dataclass(frozen=True, slots=True, kw_only=True)
    class Long:
        a: Annotated[int, u64("")]
        b: Annotated[int, u64("")]
        c: Annotated[int, u64("")]
        d: Annotated[int, u64("")]

    longer = Table(types=ADDED.types, messages={**ADDED.messages, 0x78: Message(record=Long)})
    assert longer.longest_command == TABLE.longest_command + 4
    assert f"AB_RECEIVE_BYTES = {longer.longest_command - 2}" in c_header(longer)
