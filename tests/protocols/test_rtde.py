import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.errors import ControllerError
from armodal.protocols.rtde import (
    OUTPUTS,
    RtdeKind,
    RtdeParser,
    decode_accepted,
    decode_outputs,
    decode_sample,
    request_outputs,
    request_start,
    request_version,
)

JOINTS_RAD = (0.1, -0.2, 0.3, -0.4, 0.5, -0.6)


def sample(*, recipe=1, joints_rad=JOINTS_RAD, mode=7, status=1):
    return struct.pack(">Bd6diI", recipe, 12.5, *joints_rad, mode, status)


def test_requests_are_those_of_the_guide():
    assert request_version() == b"\x00\x05V\x00\x02"
    assert request_start() == b"\x00\x03S"
    names = b"timestamp,actual_q,robot_mode,robot_status_bits"
    assert request_outputs(125.0) == b"\x00\x3aO" + struct.pack(">d", 125.0) + names


def test_a_sample_tells_angles_and_whether_the_arm_is_held():
    found = decode_sample(sample(), 1)
    assert found.joints_rad == JOINTS_RAD
    assert (found.timestamp_s, found.drive_state, found.held) == (12.5, 7, True)


@pytest.mark.parametrize(
    ("mode", "status", "held"),
    [(5, 1, True), (7, 3, True), (7, 5, False), (6, 1, False), (3, 0, False), (-1, 0, False)],
)
def test_only_brakes_or_drives_hold(mode, status, held):
    assert decode_sample(sample(mode=mode, status=status), 1).held is held


def test_what_is_no_sample_of_ours_is_none():
    assert decode_sample(sample()[:-1], 1) is None
    assert decode_sample(sample(recipe=2), 1) is None
    assert decode_sample(sample(joints_rad=(float("nan"),) * 6), 1) is None


def test_an_output_that_cannot_be_had_is_named():
    types = ",".join(["DOUBLE", "NOT_FOUND", "INT32", "UINT32"])
    with pytest.raises(ControllerError, match="actual_q NOT_FOUND in place of VECTOR6D"):
        decode_outputs(b"\x01" + types.encode())
    with pytest.raises(ControllerError, match="a type for each of 4 outputs"):
        decode_outputs(b"")
    assert decode_outputs(b"\x07" + ",".join(OUTPUTS.values()).encode()) == 7


def test_an_answer_of_another_length_is_refused():
    with pytest.raises(ControllerError, match="wanted an answer of 1 byte"):
        decode_accepted(b"")


def test_a_stream_that_is_not_rtde_is_refused():
    with pytest.raises(ControllerError, match="port 30004"):
        list(RtdeParser().feed(b"\x00\x02SSH"))


@given(
    st.lists(st.binary(max_size=40), max_size=6),
    st.lists(st.integers(0, 250), max_size=6),
)
def test_packages_are_cut_alike_however_they_come(payloads, cuts):
    kinds = [ord("U"), ord("M")] * 3
    data = b"".join(
        struct.pack(">HB", 3 + len(p), kind) + p for kind, p in zip(kinds, payloads, strict=False)
    )
    parser, found, at = RtdeParser(), [], 0
    for cut in [*sorted(cuts), len(data)]:
        found += parser.feed(data[at : max(cut, at)])
        at = max(cut, at)
    assert [p.payload for p in found] == payloads
    assert [p.kind for p in found] == [
        RtdeKind.DATA,
        None,
        RtdeKind.DATA,
        None,
        RtdeKind.DATA,
        None,
    ][: len(payloads)]


@given(st.binary(max_size=200))
def test_any_bytes_are_packages_or_refused(data):
    try:
        for package in RtdeParser().feed(data):
            decode_sample(package.payload, 1)
    except ControllerError:
        return
