from __future__ import annotations

import contextlib
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from can.util import dlc2len, len2dlc
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm
from armodal.protocols.arm.records import CanMapping
from armodal.protocols.can_database import (
    DBC_DIRECTORY,
    CanDecoder,
    CanEncoder,
    CanFrame,
    load_database,
)
from armodal.protocols.can_records import bytes_carried
from armodal.protocols.errors import CanError
from armodal.protocols.slcan import SlcanParser

JOINTS = [f"joint_{number}" for number in range(1, 7)]
# Half a count of 0.0001 degree, with room for rounding in float64.
HALF_COUNT_RAD = math.radians(0.5e-4) * 1.001


def shipped_mapping() -> CanMapping:
    mapping = load_arm("rv4frl").can
    assert mapping is not None
    return mapping


def cia402_mapping() -> CanMapping:
    mapping = load_arm(ARMS_DIRECTORY / "examples" / "rv4frl-cia402.toml").can
    assert mapping is not None
    return mapping


def joints_1_2(position_1: int, position_2: int, state: int, counter: int) -> CanFrame:
    """The frame by hand, as docs/can.md lays it out."""
    data = (
        position_1.to_bytes(3, "little", signed=True)
        + position_2.to_bytes(3, "little", signed=True)
        + bytes([state, counter])
    )
    return CanFrame(can_id=0x301, extended=False, data=data)


@given(
    st.lists(st.floats(-14.0, 14.0), min_size=6, max_size=6),
    st.sampled_from([0, 1, 2, 3, 15]),
    st.integers(0, 255),
)
def test_angles_round_trip_within_half_a_count(
    angles: list[float], state: int, counter: int
) -> None:
    mapping = shipped_mapping()
    sent = dict(zip(JOINTS, angles, strict=True))
    decoder = CanDecoder(mapping)
    got: dict[str, float] = {}
    for frame in CanEncoder(mapping).encode(sent, drive_state=state, counter=counter):
        update = decoder.decode(frame)
        assert update is not None
        assert (update.counter, update.drive_state) == (counter, state)
        got |= update.joints_rad
    assert got == pytest.approx(sent, abs=HALF_COUNT_RAD)


def test_a_frame_laid_out_by_hand_is_decoded() -> None:
    update = CanDecoder(shipped_mapping()).decode(joints_1_2(-250_000, 900_000, 2, 17))
    assert update is not None
    # The closed form: a quarter of a hundred degrees, and a right angle.
    expected = {"joint_1": math.radians(-25.0), "joint_2": math.pi / 2}
    assert update.joints_rad == pytest.approx(expected, abs=1e-12)
    assert (update.message, update.counter, update.drive_state) == ("JOINTS_1_2", 17, 2)


def test_scale_sign_and_offset_turn_counts_into_joint_angles() -> None:
    mapping = cia402_mapping()
    joint = replace(mapping.joints[1], offset_rad=0.25)
    mapping = replace(mapping, joints=(mapping.joints[0], joint, *mapping.joints[2:]))
    # A motor turn and a half behind the example's gear of 120, with sign -1.
    counts = 131072 * 3 // 2
    data = (0x0237).to_bytes(2, "little") + counts.to_bytes(4, "little", signed=True)
    update = CanDecoder(mapping).decode(CanFrame(can_id=0x182, extended=False, data=data))
    assert update is not None
    expected = 0.25 - 3.0 * math.pi / 120.0
    assert update.joints_rad == pytest.approx({"joint_2": expected}, abs=1e-12)
    assert update.drive_state == 0x37


def test_cia402_drives_are_held_only_when_all_six_are_enabled() -> None:
    decoder = CanDecoder(cia402_mapping())
    states = []
    for node, word in [(1, 0x0637), (2, 0x0627), (3, 0x0637), (4, 0x0637), (5, 0x0637)]:
        frame = CanFrame(
            can_id=0x180 + node, extended=False, data=word.to_bytes(2, "little") + bytes(4)
        )
        update = decoder.decode(frame)
        assert update is not None
        states.append(update.held)
    assert states == [False] * 5  # node 6 has not spoken
    for word, held in [(0x0637, True), (0x0608, False)]:  # then a fault
        frame = CanFrame(can_id=0x186, extended=False, data=word.to_bytes(2, "little") + bytes(4))
        update = decoder.decode(frame)
        assert update is not None
        assert update.held is held
    assert update.drive_state == 0x08


def test_one_message_not_held_is_enough_whichever_speaks_last() -> None:
    mapping = shipped_mapping()
    encoder, decoder = CanEncoder(mapping), CanDecoder(mapping)
    angles = dict.fromkeys(JOINTS, 0.0)
    for frame in encoder.encode(angles, drive_state=2, counter=0):
        update = decoder.decode(frame)
    assert update is not None
    assert update.held is True
    decoder.decode(joints_1_2(0, 0, 15, 1))
    for frame in encoder.encode(angles, drive_state=2, counter=1)[1:]:
        update = decoder.decode(frame)
        assert update is not None
        assert (update.held, update.drive_state) == (False, 15)


@given(st.lists(st.integers(1, 255), min_size=1, max_size=20), st.integers(0, 255))
def test_skipped_counters_are_counted_as_lost_frames(steps: list[int], start: int) -> None:
    decoder = CanDecoder(shipped_mapping())
    decoder.decode(joints_1_2(0, 0, 2, start))
    counter, lost = start, 0
    for step in steps:
        counter = (counter + step) % 256
        update = decoder.decode(joints_1_2(0, 0, 2, counter))
        assert update is not None
        lost += update.lost
    assert lost == sum(steps) - len(steps)


def test_a_repeated_counter_renews_no_angle() -> None:
    decoder = CanDecoder(shipped_mapping())
    decoder.decode(joints_1_2(1, 2, 2, 9))
    update = decoder.decode(joints_1_2(1, 2, 2, 9))
    assert update is not None
    assert update.repeated
    assert update.joints_rad == {}
    assert update.lost == 0


def test_the_worked_example_of_the_document_is_right() -> None:
    document = Path(__file__).parents[2] / "docs" / "can.md"
    found = re.search(r"`(t[0-9A-F]+)` and CR", document.read_text(encoding="utf-8"))
    assert found is not None
    (frame,) = SlcanParser().feed(found[1].encode("ascii") + b"\r")
    assert frame == joints_1_2(-250_000, 900_000, 2, 17)


@pytest.mark.parametrize("length", [0, 1, 7])
def test_short_frames_are_refused_and_change_nothing(length: int) -> None:
    decoder = CanDecoder(shipped_mapping())
    decoder.decode(joints_1_2(0, 0, 2, 9))
    with pytest.raises(CanError, match=f"JOINTS_1_2: wanted 8 bytes, got {length}"):
        decoder.decode(CanFrame(can_id=0x301, extended=False, data=bytes(length)))
    update = decoder.decode(joints_1_2(0, 0, 2, 10))
    assert update is not None
    assert update.lost == 0


def test_an_angle_not_available_is_refused() -> None:
    with pytest.raises(CanError, match=r"JOINTS_1_2.POSITION_1: wanted .* not available"):
        CanDecoder(shipped_mapping()).decode(joints_1_2(-(2**23), 0, 2, 0))


def test_the_ends_of_the_range_are_inside_it() -> None:
    update = CanDecoder(shipped_mapping()).decode(joints_1_2(2**23 - 1, 1 - 2**23, 2, 0))
    assert update is not None
    assert len(update.joints_rad) == 2


@pytest.mark.parametrize("outside", [1_800_001, -1_800_001])
def test_an_angle_one_count_outside_its_range_is_refused(outside: int) -> None:
    mapping = shipped_mapping()
    narrow = mapping.database_text.replace("[-838.8607|838.8607]", "[-180|180]")
    decoder = CanDecoder(replace(mapping, database_text=narrow))
    end = 1_800_000 if outside > 0 else -1_800_000
    update = decoder.decode(joints_1_2(0, end, 2, 0))
    assert update is not None
    assert update.signals["POSITION_2"] == pytest.approx(end * 1e-4)
    with pytest.raises(CanError, match=r"JOINTS_1_2.POSITION_2: wanted -180 to 180"):
        decoder.decode(joints_1_2(0, outside, 2, 1))


@pytest.mark.parametrize("change", [{"extended": True}, {"remote": True}, {"can_id": 0x304}])
def test_another_kind_of_frame_with_our_content_is_not_ours(change: dict[str, int]) -> None:
    decoder = CanDecoder(shipped_mapping())
    ours = joints_1_2(1, 2, 2, 9)
    assert decoder.decode(replace(ours, **change)) is None
    update = decoder.decode(ours)
    assert update is not None
    assert not update.repeated


def test_a_remote_frame_without_data_is_not_ours() -> None:
    frame = CanFrame(can_id=0x301, extended=False, data=b"", remote=True)
    assert CanDecoder(shipped_mapping()).decode(frame) is None


OUR_IDS = [0x301, 0x302, 0x303]


@pytest.fixture(scope="module")
def decoder() -> CanDecoder:
    return CanDecoder(shipped_mapping())


@given(
    st.sampled_from(OUR_IDS) | st.integers(0, 0x7FF),
    st.booleans(),
    st.binary(min_size=8, max_size=8) | st.binary(max_size=8),
    st.booleans(),
)
def test_any_frame_decodes_or_is_refused_or_is_not_ours(
    decoder: CanDecoder, can_id: int, extended: bool, data: bytes, remote: bool
) -> None:
    frame = CanFrame(can_id=can_id, extended=extended, data=data, remote=remote)
    ours = can_id in OUR_IDS and not extended and not remote
    try:
        assert (decoder.decode(frame) is not None) == ours
    except CanError:
        assert ours
        assert len(data) != 8 or bytes([0, 0, 0x80]) in (data[:3], data[3:6])


def test_a_mapping_without_state_and_counter_tells_neither() -> None:
    mapping = replace(shipped_mapping(), drive_state=None, counter=None)
    update = CanDecoder(mapping).decode(joints_1_2(0, 0, 15, 3))
    assert update is not None
    assert (update.drive_state, update.held, update.counter) == (None, None, None)


def test_angles_beyond_the_signal_are_not_encoded() -> None:
    encoder = CanEncoder(shipped_mapping())
    with pytest.raises(CanError, match="JOINTS_1_2 cannot be encoded"):
        encoder.encode(dict.fromkeys(JOINTS, 20.0), drive_state=2, counter=0)
    with pytest.raises(CanError, match="wanted an angle of joint_1"):
        encoder.encode({}, drive_state=2, counter=0)


def fd_mapping() -> CanMapping:
    """All six angles, state and counter in one message of 22 bytes: no classic frame is so long."""
    signals = "".join(
        f' SG_ POSITION_{i + 1} : {24 * i}|24@1- (0.0001,0) [0|0] "deg" A\n' for i in range(6)
    )
    text = (
        f'VERSION ""\n\nBU_: A\n\nBO_ 785 ALL: 22 A\n{signals}'
        ' SG_ STATE : 144|8@1+ (1,0) [0|255] "" A\n SG_ COUNT : 152|8@1+ (1,0) [0|255] "" A\n'
    )
    ours = shipped_mapping()
    assert ours.drive_state is not None
    return replace(
        ours,
        database_text=text,
        joints=tuple(replace(joint, message="ALL") for joint in ours.joints),
        drive_state=replace(ours.drive_state, message="ALL", signal="STATE"),
        counter=("ALL", "COUNT"),
    )


def test_a_can_fd_frame_laid_out_by_hand_is_decoded_and_may_be_filled_up() -> None:
    counts = [0, 900_000, -450_000, 1, -1, 300_000]
    data = b"".join(n.to_bytes(3, "little", signed=True) for n in counts) + bytes([2, 41, 0, 0])
    assert len(data) == 22
    # The shortest FD frame of 22 bytes or more has 24, of which two say nothing.
    frame = CanFrame(can_id=785, extended=False, data=data + b"\xcc\xcc", fd=True)
    update = CanDecoder(fd_mapping()).decode(frame)
    assert update is not None
    assert list(update.joints_rad.values()) == pytest.approx(
        [math.radians(n * 1e-4) for n in counts], abs=1e-12
    )
    assert (update.drive_state, update.counter) == (2, 41)


@pytest.mark.parametrize(
    ("length", "fd", "wanted"), [(8, True, 24), (22, True, 24), (32, True, 24), (8, False, 22)]
)
def test_an_fd_message_in_a_frame_of_another_length_is_refused(length, fd, wanted) -> None:
    frame = CanFrame(can_id=785, extended=False, data=bytes(length), fd=fd)
    with pytest.raises(CanError, match=f"ALL: wanted {wanted} bytes, got {length}"):
        CanDecoder(fd_mapping()).decode(frame)


def test_what_is_encoded_for_can_fd_is_decoded() -> None:
    mapping = fd_mapping()
    sent = {name: 0.1 * i for i, name in enumerate(JOINTS)}
    (frame,) = CanEncoder(mapping).encode(sent, drive_state=2, counter=3)
    assert (frame.fd, len(frame.data)) == (True, 24)
    update = CanDecoder(mapping).decode(frame)
    assert update is not None
    assert update.joints_rad == pytest.approx(sent, abs=HALF_COUNT_RAD)


def test_lengths_of_can_fd_frames_are_python_cans() -> None:
    for length in range(65):
        assert bytes_carried(length, fd=True) == dlc2len(len2dlc(length))


@pytest.mark.parametrize("name", ["armodal_controller.dbc", "cia402.dbc"])
def test_shipped_databases_are_read(name: str) -> None:
    database = load_database((DBC_DIRECTORY / name).read_text(encoding="utf-8"), name)
    assert database.messages


@pytest.mark.long
@given(st.text(max_size=200))
def test_any_text_is_a_database_or_refused(text: str) -> None:
    with contextlib.suppress(CanError):
        load_database("BO_ 1 " + text, "x.dbc")


def test_a_message_that_would_fill_the_memory_is_refused() -> None:
    text = 'VERSION ""\nBU_: A\nBO_ 1 BIG: 4000000000 A\n SG_ S : 0|8@1+ (1,0) [0|0] "" A\n'
    with pytest.raises(CanError, match="wanted messages of at most 64 bytes, got 4000000000"):
        load_database(text, "x.dbc")


@pytest.mark.parametrize(
    "bits", ["0|9999999", "99999999999|8", "7 | 65", "-1|99999999", "0|+9999999"]
)
def test_a_signal_longer_than_a_frame_is_refused_before_its_bits_are_laid_out(bits):
    text = f'VERSION ""\n\nBU_: A\n\nBO_ 5 M: 8 A\n SG_ S : {bits}@1- (1,0) [0|0] "" A\n'
    with pytest.raises(CanError, match="wanted signals of at most 64 bits"):
        load_database(text, "a.dbc")
