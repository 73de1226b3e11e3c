import contextlib
import json
import struct
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.errors import JournalError
from armodal.protocols.session.compare import first_difference
from armodal.protocols.session.journal import (
    MAGIC,
    Mark,
    MarkKind,
    RecordKind,
    begin_journal,
    decode_journal,
    encode_hit,
    encode_loss,
    encode_mark,
    encode_record,
    load_journal,
    read_journal,
    scan,
    session_of,
)
from armodal.protocols.session.journal_framing import MAX_PAYLOAD, MAX_RECORDS, RECORD_OVERHEAD
from armodal.protocols.session.journal_payloads import (
    CALIBRATION,
    decode_end,
    decode_hit,
    decode_loss,
    decode_mark,
)
from armodal.protocols.session.records import Hit, JointReading, Loss, SessionHeader, Verdict

finite = st.floats(allow_nan=False, allow_infinity=False)
text = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=20)
index = st.integers(0, 2**63 - 1)


@st.composite
def readings(draw: st.DrawFn) -> JointReading:
    joints = draw(st.none() | st.lists(finite, max_size=7))
    return JointReading(
        joints_rad=None if joints is None else np.array(joints, dtype=np.float64),
        drive_state=draw(st.none() | st.integers(-(2**63), 2**63 - 1)),
        held=draw(st.booleans()),
        age_s=draw(st.floats(min_value=0, allow_nan=False)),
        host_s=draw(finite),
    )


@st.composite
def hits(draw: st.DrawFn) -> Hit:
    shape = (draw(st.integers(0, 5)), draw(st.integers(1, 4)))
    size = shape[0] * shape[1]
    counts = draw(st.lists(st.integers(-(2**31), 2**31 - 1), min_size=size, max_size=size))
    angle = draw(st.floats(0, 7))
    return Hit(
        number=draw(st.integers(1, 2**31 - 1)),
        posture=draw(text),
        sensor_point=draw(text),
        hit_point=draw(text),
        hit_direction=np.array([np.cos(angle), 0.0, np.sin(angle)]),
        first_sample=draw(index),
        trigger_sample=draw(index),
        trigger_host_s=draw(finite),
        counts=np.array(counts, dtype=np.int32).reshape(shape),
        before=draw(readings()),
        after=draw(readings()),
        verdict=Verdict(
            accepted=draw(st.booleans()),
            reasons=tuple(draw(st.lists(text, max_size=3))),
            notes=tuple(draw(st.lists(text, max_size=3))),
            peak_n=draw(finite | st.just(np.nan)),
            width_s=draw(finite | st.just(np.nan)),
        ),
    )


def payload_of(record: bytes) -> bytes:
    return bytes(scan(MAGIC + record).records[0].payload)


@given(hit=hits())
def test_hit_round_trips(hit: Hit) -> None:
    assert first_difference(decode_hit(payload_of(encode_hit(hit))), hit, "hit") is None


@given(
    loss=st.builds(
        Loss, kind=text, count=index, first_sample=st.none() | index, host_s=finite, note=text
    )
)
def test_loss_round_trips(loss: Loss) -> None:
    assert decode_loss(payload_of(encode_loss(loss))) == loss


@given(
    mark=st.builds(
        Mark,
        kind=st.sampled_from(MarkKind),
        posture=st.none() | text,
        point=st.none() | text,
        host_s=finite,
        note=text,
    )
)
def test_mark_round_trips(mark: Mark) -> None:
    assert decode_mark(payload_of(encode_mark(mark))) == mark


@given(data=st.binary(max_size=200))
@pytest.mark.parametrize("decode", [decode_hit, decode_loss, decode_mark, decode_end])
def test_any_payload_decodes_or_raises_journal_error(
    decode: Callable[[bytes], object], data: bytes
) -> None:
    with contextlib.suppress(JournalError):
        decode(data)


@given(data=st.binary(max_size=300), with_magic=st.booleans())
def test_any_bytes_scan_or_say_why(data: bytes, with_magic: bool) -> None:
    try:
        found = scan(MAGIC + data if with_magic else data)
    except JournalError:
        return
    assert len(MAGIC) <= found.good_end <= found.size
    assert bool(found.damage) == (found.dropped_bytes > 0)


@given(payloads=st.lists(st.binary(max_size=40), max_size=5), tail=st.binary(max_size=20))
def test_scan_finds_every_record_before_the_damage(payloads: list[bytes], tail: bytes) -> None:
    data = MAGIC + b"".join(encode_record(RecordKind.MARK, payload) for payload in payloads)
    found = scan(data + tail)
    # Twenty random bytes are a record with a probability of 2^-48.
    assert [bytes(record.payload) for record in found.records] == payloads
    assert found.good_end == len(data)
    assert found.dropped_bytes == len(tail)


def test_record_is_laid_out_as_documented() -> None:
    payload = b"payload"
    head = struct.pack("<IHH", len(payload), 4, 0x4A52)
    body = head + payload
    assert encode_record(RecordKind.MARK, payload) == body + struct.pack("<I", zlib.crc32(body))


def test_journal_gives_the_session_back(example, tmp_path: Path) -> None:
    path = tmp_path / "a.journal"
    path.write_bytes(example.journal)
    assert first_difference(load_journal(path), example.session, "session") is None
    journal = read_journal(path)
    assert journal.end is not None
    assert [mark.kind for mark in journal.marks] == [MarkKind.POSTURE, MarkKind.SKIPPED]
    assert journal.good_end == len(example.journal)


def test_a_calibration_noted_in_the_journal_goes_with_the_data(header) -> None:
    def note(text: str) -> bytes:
        mark = Mark(kind=MarkKind.NOTE, posture=None, point=None, host_s=1.0, note=text)
        return encode_mark(mark)

    told = f"{CALIBRATION}hammer and accelerometer 1.02"
    data = begin_journal(header) + note("the arm is held") + note(told)
    assert session_of(decode_journal(data)).warnings[-1:] == (told,)
    assert not any("held" in words for words in session_of(decode_journal(data)).warnings)


def test_every_complete_record_survives_truncation_at_every_byte(example) -> None:
    data = example.journal
    ends = np.cumsum([len(record) for record in example.records])
    for cut in range(int(ends[0]), len(data) + 1):
        found = scan(data[:cut])
        complete = int(np.searchsorted(ends, cut, side="right"))
        assert len(found.records) == complete
        assert found.good_end == ends[complete - 1]
        assert found.may_append


def test_truncation_within_the_header_leaves_nothing_and_says_so(example) -> None:
    for cut in (0, 1, 8, 9, 100, len(example.records[0]) - 1):
        with pytest.raises(JournalError, match=r"remove it, and begin the session anew"):
            decode_journal(example.journal[:cut])


def test_torn_tail_becomes_a_warning(example) -> None:
    torn = example.journal[:-3]
    session = session_of(decode_journal(torn))
    assert first_difference(session.hits, example.session.hits, "hits") is None
    assert any("bytes behind are dropped" in warning for warning in session.warnings)
    assert any("not closed" in warning for warning in session.warnings)


def test_appending_goes_on_at_the_good_end(example) -> None:
    head = b"".join(example.records[:3])
    torn = decode_journal(head + example.records[4][:-1])
    assert torn.good_end == len(head)
    continued = decode_journal(head + b"".join(example.records[4:]))
    assert len(continued.hits) == 3
    assert continued.dropped_bytes == 0


def test_resumed_session_is_open_again(example, make_hit: Callable[..., Hit]) -> None:
    resumed = Mark(kind=MarkKind.RESUMED, posture=None, point=None, host_s=20.0)
    data = example.journal + encode_mark(resumed) + encode_hit(make_hit(4))
    journal = decode_journal(data)
    assert journal.end is None
    assert len(journal.hits) == 4


def test_damage_before_good_records_forbids_appending(example) -> None:
    data = bytearray(example.journal)
    place = len(b"".join(example.records[:4])) + 60
    data[place] ^= 0x10
    journal = decode_journal(bytes(data))
    assert len(journal.hits) == 1
    assert not journal.may_append
    beyond = len(example.records) - 5
    assert any(f"{beyond} complete records lie behind" in text for text in journal.warnings)


def test_every_flipped_bit_in_a_hit_is_noticed(example) -> None:
    record = example.records[2]
    for bit in range(8 * len(record)):
        data = bytearray(MAGIC + record)
        data[len(MAGIC) + bit // 8] ^= 1 << bit % 8
        assert scan(bytes(data)).records == ()


def test_session_is_complete_when_every_planned_point_has_its_hits(
    header: SessionHeader, make_hit: Callable[..., Hit]
) -> None:
    plan = header.plan
    wanted = [
        (posture.name, point)
        for posture in plan.postures
        for point in posture.points
        for _ in range(plan.hits_per_point)
    ]
    records = [begin_journal(header)]
    for number, (posture, point) in enumerate(wanted, start=1):
        hit = make_hit(number, samples=1, sensor_point=point, posture_name=posture)
        records.append(encode_hit(hit))
    assert session_of(decode_journal(b"".join(records))).complete
    assert not session_of(decode_journal(b"".join(records[:-1]))).complete


def test_unknown_kind_is_passed_over_and_said(example) -> None:
    data = example.records[0] + encode_record(77, b"later") + example.records[2]
    journal = decode_journal(data)
    assert len(journal.hits) == 1
    assert any("does not know" in warning for warning in journal.warnings)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"\x89HDF\r\n\x1a\n", "not an armodal journal"),
        (MAGIC[:-1] + b"\x02", "version 2"),
        (b"\x89AMJ\n\x1a\x01" + bytes(20), "not an armodal journal"),
        (MAGIC, "no complete record"),
        (MAGIC + encode_record(RecordKind.MARK, b"{}"), "begins with HEADER"),
        (MAGIC + encode_record(RecordKind.HEADER, b"\xff\xff\xff\xff{}"), "announced"),
        (MAGIC + encode_record(RecordKind.HEADER, b"\2\0\0\0{}"), "Field required"),
    ],
)
def test_what_is_not_a_journal_is_refused_in_words(data: bytes, says: str) -> None:
    with pytest.raises(JournalError, match=says):
        decode_journal(data)


def test_announced_length_is_not_believed() -> None:
    data = MAGIC + struct.pack("<IHH", 0xFFFFFFFF, 2, 0x4A52) + bytes(64)
    assert scan(data).records == ()
    data = MAGIC + struct.pack("<IHH", MAX_PAYLOAD, 2, 0x4A52) + bytes(64)
    assert scan(data).records == ()


def test_record_larger_than_the_limit_is_not_written() -> None:
    with pytest.raises(JournalError, match="at most"):
        encode_record(RecordKind.HIT, bytes(MAX_PAYLOAD + 1))


def test_flood_of_tiny_records_is_refused() -> None:
    record = encode_record(RecordKind.LOSS, b"")
    assert len(record) == RECORD_OVERHEAD
    with pytest.raises(JournalError, match="holds more"):
        scan(MAGIC + record * (MAX_RECORDS + 1))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"n_samples": 9}, "bytes of counts"),
        ({"n_samples": -1}, "n_samples"),
        ({"n_channels": True}, "n_channels"),
        ({"number": 1.0}, "number"),
        ({"extra": 1}, "extra"),
        ({"hit_direction": [0, 0, 2]}, "unit vector"),
        ({"trigger_host_s": float("inf")}, "HIT"),
        ({"posture": "a" * 300}, "posture"),
        ({"first_sample": 10**4000}, "HIT"),
        ({"before": [[[[]]]]}, "before"),
    ],
)
def test_impossible_metadata_is_refused_with_its_key(
    make_hit: Callable[..., Hit], change: dict[str, object], says: str
) -> None:
    payload = payload_of(encode_hit(make_hit(1)))
    length = struct.unpack_from("<I", payload)[0]
    values = json.loads(payload[4 : 4 + length]) | change
    changed = json.dumps(values).encode()
    with pytest.raises(JournalError, match=says):
        decode_hit(struct.pack("<I", len(changed)) + changed + payload[4 + length :])


@pytest.mark.parametrize(
    "raw",
    [
        b'{"reason":"a","reason":"b","host_s":1}',
        b'{"reason":"a","host_s":NaN}',
        b'{"reason":"a","host_s":1e999}',
        b'{"reason":"\xff","host_s":1}',
        b'{"reason":"\\ud800","host_s":1}',
        b'{"reason":"\\u0000","host_s":1}',
        b"[" * 100_000,
        b'{"reason":' + b"[" * 100_000,
        b"",
    ],
)
def test_loose_json_is_refused(raw: bytes) -> None:
    with pytest.raises(JournalError, match="END"):
        decode_end(raw)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"posture": "elsewhere"}, "no posture"),
        ({"sensor_point": "99"}, "no point"),
        ({"counts": np.zeros((4, 3), dtype=np.int32)}, "channels"),
        ({"number": 1}, "have to rise"),
    ],
)
def test_hit_of_another_session_is_refused_with_its_place(
    example, make_hit: Callable[..., Hit], change: dict[str, object], says: str
) -> None:
    head = b"".join(example.records[:3])
    stranger = encode_hit(replace(make_hit(5), **change))
    with pytest.raises(JournalError, match=f"byte {len(head)}: .*{says}"):
        decode_journal(head + stranger)


def test_header_with_exchanged_text_is_refused(example) -> None:
    payload = bytes(scan(example.journal).records[0].payload)
    length = struct.unpack_from("<I", payload)[0]
    values = json.loads(payload[4 : 4 + length])
    values["arm_text"] += "\n# a later thought\n"
    changed = json.dumps(values).encode()
    record = struct.pack("<I", len(changed)) + changed + payload[4 + length :]
    with pytest.raises(JournalError, match="not the one the session began with"):
        decode_journal(MAGIC + encode_record(RecordKind.HEADER, record))


def test_header_that_could_not_be_read_back_is_not_written(header: SessionHeader) -> None:
    with pytest.raises(JournalError, match="dictionary"):
        begin_journal(replace(header, dictionary_bytes=b"\0"))
    other = replace(header.dictionary, board_id="another")
    with pytest.raises(JournalError, match="dictionary"):
        begin_journal(replace(header, dictionary=other))
    with pytest.raises(JournalError, match="channel mask"):
        begin_journal(replace(header, channel_mask=0b10000))


def test_missing_file_is_one_clear_message(tmp_path: Path) -> None:
    with pytest.raises(JournalError, match="cannot read the journal"):
        load_journal(tmp_path / "none.journal")
    with pytest.raises(JournalError, match="cannot read the journal"):
        load_journal(tmp_path)


def test_numpy_scalars_are_written_as_numbers(make_hit: Callable[..., Hit]) -> None:
    hit = make_hit(2)
    numpy_hit = replace(
        hit, first_sample=np.int64(hit.first_sample), trigger_host_s=np.float64(hit.trigger_host_s)
    )
    assert encode_hit(numpy_hit) == encode_hit(hit)
