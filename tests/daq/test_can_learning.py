"""What is learned of a bus is what its controller says, whatever its format."""

import struct

import numpy as np
import pytest

from armodal.daq.can_learning import Station, can_section_text, database_text, learn
from armodal.hil_sim.joint_messages import JointMessages
from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm
from armodal.protocols.arm.generic_can import generic_mapping
from armodal.protocols.can_database import load_database
from armodal.protocols.can_records import CanFrame
from armodal.protocols.errors import CanError
from armodal.protocols.slcan import SlcanParser

FRAMES = 20
NOISE_DEG = 2e-4


def postures_deg(n, *, decimals=1, seed=3):
    """Each joint moved alone, twice, across zero; what the pendant shows of it."""
    rng = np.random.default_rng(seed)
    now = rng.uniform(-40.0, 40.0, n)
    rows = [now.copy()]
    for i in range(n):
        for sign in (1.0, -1.0):
            now[i] = sign * rng.uniform(25.0, 70.0)
            rows.append(now.copy())
    return rows, [tuple(np.round(row, decimals).tolist()) for row in rows]


def stations_of(send, n, *, seed=5, **settings):
    """Stations of a controller: `send(q_deg, cycle)` gives the frames of a cycle."""
    rng = np.random.default_rng(seed)
    true, shown = postures_deg(n, **settings)
    cycle = 0
    stations = []
    for row, told in zip(true, shown, strict=True):
        frames = []
        for _ in range(FRAMES):
            frames += send(row + NOISE_DEG * rng.standard_normal(n), cycle)
            cycle += 1
        stations.append(Station(joints_deg=told, frames=tuple(frames)))
    return stations


def learned_of(send, n, *, rounding_deg=0.05, **settings):
    names = [f"axis {i + 1}" for i in range(n)]
    stations = stations_of(send, n, **settings)
    return learn(stations, names, [(-170.0, 170.0)] * n, rounding_deg=rounding_deg)


def by_mapping(mapping, names):
    messages, parser = JointMessages(mapping, names), SlcanParser()
    return lambda q, cycle: list(
        parser.feed(messages.lines(np.radians(q).tolist(), moving=False, counter=cycle))
    )


def packed(layout):
    """A controller that writes each joint by struct into a frame of its own."""
    return lambda q, cycle: [
        CanFrame(can_id=0x200 + i, extended=False, data=layout(angle, cycle))
        for i, angle in enumerate(q)
    ]


@pytest.mark.parametrize("n", [1, 4, pytest.param(9, marks=pytest.mark.long)])
def test_the_generic_description_is_learned_of_any_number_of_joints(n):
    names = [f"axis {i + 1}" for i in range(n)]
    found = learned_of(by_mapping(generic_mapping(names), names), n)
    assert found.missing == {}
    for i, joint in enumerate(found.joints):
        field = joint.field
        assert (field.can_id, field.first_byte) == (0x301 + i // 2, 3 * (i % 2))
        assert (joint.factor_deg, joint.offset_deg, joint.is_round) == (1e-4, 0.0, True)
    assert found.counters[0x301, False] == 7


def test_drives_behind_gears_are_learned_with_their_signs_and_what_that_leaves_unsure():
    arm = load_arm(ARMS_DIRECTORY / "examples" / "rv4frl-cia402.toml")
    names = [joint.name for joint in arm.joints]
    found = learned_of(by_mapping(arm.can, names), 6)
    assert found.missing == {}
    for joint, signal in zip(found.joints, arm.can.joints, strict=True):
        true = signal.sign * np.degrees(signal.scale_rad)
        assert not joint.is_round
        # Anywhere in the range, the learned angle is within what is told.
        assert abs(joint.factor_deg / true - 1.0) * 170.0 < joint.error_deg < 0.5


@pytest.mark.parametrize(
    ("layout", "kind", "factor"),
    [
        (lambda q, _: struct.pack(">i", round(q * 1000)), "signed", 1e-3),
        (lambda q, _: struct.pack("<f", q), "float", 1.0),
        (lambda q, _: struct.pack(">d", np.radians(q)), "float", np.degrees(1.0)),
        (lambda q, c: struct.pack(">BhB", 7, round(q * 100), c & 0xFF), "signed", 0.01),
        (lambda q, _: struct.pack("<H", round((q + 180.0) * 65536 / 360)), "unsigned", 360 / 65536),
    ],
)
def test_other_formats_are_learned(layout, kind, factor):
    found = learned_of(packed(layout), 3)
    assert found.missing == {}
    for joint in found.joints:
        assert joint.field.format.kind == kind
        assert joint.factor_deg == pytest.approx(factor, rel=1e-12)
        # The unsigned one is 180 degrees off; the pendant's rounding is halved.
        assert joint.residual_deg < 0.06


def test_joints_in_one_can_fd_frame_are_learned_and_its_description_is_read():
    def send(q, _):
        data = bytes(16) + b"".join(struct.pack("<i", round(angle * 1e4)) for angle in q)
        return [CanFrame(can_id=0x311, extended=False, data=data.ljust(32, b"\xaa"), fd=True)]

    found = learned_of(send, 3)
    assert found.missing == {}
    assert [joint.field.first_byte for joint in found.joints] == [16, 20, 24]
    (message,) = load_database(database_text(found), "learned.dbc").messages
    assert message.length == 32


def test_a_coupled_gear_is_told_as_such():
    def send(q, cycle):
        motors = q * [1.0, 1.0, 1.0] + [0.0, 0.0, 0.4 * q[1]]
        return packed(lambda angle, _: struct.pack("<i", round(angle * 1e4)))(motors, cycle)

    found = learned_of(send, 3)
    assert list(found.missing) == ["axis 3"]
    assert "together with axis 2" in found.missing["axis 3"]


def test_a_joint_that_is_not_told_is_missing_and_the_others_are_found():
    names = ["a", "b", "c"]
    speaks = by_mapping(generic_mapping(names[:2]), names[:2])
    found = learned_of(lambda q, cycle: speaks(q[:2], cycle), 3)
    assert found.missing == {"axis 3": "no whole-byte field follows it alone"}


def test_a_joint_that_was_not_moved_twice_or_a_silent_bus_is_refused():
    names = ["a", "b"]
    stations = stations_of(by_mapping(generic_mapping(names), names), 2)[:3]
    with pytest.raises(CanError, match="got fewer of b"):
        learn(stations, names, [(-170.0, 170.0)] * 2, rounding_deg=0.05)
    silent = stations_of(lambda *_: [], 2)
    with pytest.raises(CanError, match="wanted frames of one identifier at every station"):
        learn(silent, names, [(-170.0, 170.0)] * 2, rounding_deg=0.05)


def test_the_files_say_what_was_learned():
    found = learned_of(packed(lambda q, _: struct.pack(">f", np.radians(q))), 2)
    database = database_text(found)
    assert "SIG_VALTYPE_ 512 POSITION_1 : 1;" in database
    section = can_section_text(found, database="x.dbc", bitrate=500_000, rate_hz=100.0)
    assert 'message = "FRAME_201", signal = "POSITION_2"' in section
