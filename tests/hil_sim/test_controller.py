from dataclasses import replace
from importlib import resources

import numpy as np
import pytest
from cantools.database import load_string
from hypothesis import given
from hypothesis import strategies as st

from armodal.hil_sim.controller import ENCODER_NOISE_RAD, ENCODER_STEP_RAD, MAX_SPEED_RAD_S
from armodal.hil_sim.joint_messages import HELD, MOVING, JointMessages
from armodal.hil_sim.slcan_adapter import SlcanAdapter
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import PlantError
from armodal.protocols.slcan import CanFrame, SlcanParser, listen_only_commands

RATE = 500_000
DATABASE = load_string(
    (resources.files("armodal.protocols") / "dbc" / "armodal_controller.dbc").read_text(), "dbc"
)


def open_listener(bench):
    for command in listen_only_commands(RATE):
        bench.listener.write(command)
        assert bench.listener.read_until(bool) == b"\r"


def told(bench, seconds, step_s=0.01):
    parser, signals = SlcanParser(), []
    for _ in range(round(seconds / step_s)):
        bench.time.now_s += step_s
        for frame in parser.feed(bench.listener.read()):
            assert isinstance(frame, CanFrame)
            signals.append(DATABASE.decode_message(frame.can_id, frame.data, decode_choices=False))
    assert parser.faults == 0
    return signals


def angles(signals):
    """(n_cycles, 6) degrees."""
    return np.array(
        [
            [[s[f"POSITION_{i}"] for s in signals if f"POSITION_{i}" in s] for i in range(1, 7)],
        ]
    )[0].T


def test_nothing_is_told_before_the_channel_is_open(bench):
    bench.time.now_s += 1.0
    assert bench.listener.read() == b""


def test_six_angles_are_told_at_125_hz(bench):
    open_listener(bench)
    signals = told(bench, 2.0)
    # One cycle either way for the phase of the first step.
    assert len(signals) / 3 == pytest.approx(250, abs=1)
    counters = [s["COUNTER"] for s in signals[::3]]
    assert set(np.diff(counters) % 256) == {1}
    assert {s["DRIVE_STATE"] for s in signals} == {HELD}


def test_angles_are_true_but_for_encoder_noise_and_step(bench):
    open_listener(bench)
    bench.controller.move_to(np.radians([10.0, -20.0, 30.0, -40.0, 50.0, -60.0]))
    told(bench, 5.0)
    q = angles(told(bench, 2.0))
    # Encoder step and half a bit of the frame (1e-4 deg) each round once, noise within 5 sigma.
    allowed = np.degrees(ENCODER_STEP_RAD / 2 + 5 * ENCODER_NOISE_RAD) + 5e-5
    np.testing.assert_allclose(
        q, np.broadcast_to([10.0, -20.0, 30.0, -40.0, 50.0, -60.0], q.shape), atol=allowed
    )


def test_a_motion_takes_time_and_says_moving_meanwhile(bench):
    open_listener(bench)
    begin_s = bench.time()
    settled_s = bench.controller.move_to(np.radians([90.0, 0, 0, 0, 0, 0]))
    assert bench.cell.moving
    signals = told(bench, settled_s - begin_s + 0.1)
    moving = [s["DRIVE_STATE"] == MOVING for s in signals[::3]]
    # Peak speed is 15/8 of the mean; one cycle at either end.
    expected = 1.875 * np.pi / 2 / MAX_SPEED_RAD_S * 125
    assert sum(moving) == pytest.approx(expected, abs=2)
    assert not bench.cell.moving
    np.testing.assert_allclose(bench.cell.joints_rad, np.radians([90.0, 0, 0, 0, 0, 0]))
    steps = np.abs(np.diff(np.radians(angles(signals)[:, 0])))
    # Noise and steps of the encoder beside the way in one cycle.
    assert steps.max() < MAX_SPEED_RAD_S / 125 * 1.05


def test_silence_is_a_fault_that_can_be_switched(bench):
    open_listener(bench)
    assert told(bench, 0.5)
    bench.faults.switch("can-silence", active=True)
    assert told(bench, 0.5) == []
    bench.faults.switch("can-silence", active=False)
    assert told(bench, 0.5)


def test_a_listener_that_does_not_read_loses_frames_and_the_adapter_says_so(bench):
    open_listener(bench)
    for _ in range(1000):
        bench.time.now_s += 0.05
        bench.controller.step()
    assert bench.controller.frames_lost > 0
    assert bench.can_port.pending < 16 * 1024
    while bench.listener.read():
        pass
    bench.listener.write(b"F\r")
    assert b"F01\r" in bench.listener.read_until(lambda got: got.endswith(b"\r") and b"F" in got)


@pytest.mark.parametrize(
    ("commands", "answer"),
    [
        (b"V\r", b"V1013\r"),
        (b"N\r", b"NS042\r"),
        (b"\r", b"\r"),
        (b"L\r", b"\x07"),  # no bit rate yet
        (b"S6\rL\r", b"\r\r"),
        (b"S6\rL\rL\r", b"\r\r\x07"),
        (b"S6\rL\rS5\r", b"\r\r\x07"),
        (b"S9\r", b"\x07"),
        (b"C\rC\r", b"\r\r"),
        (b"S6\rO\rF\r", b"\r\rF00\r"),
        (b"nonsense\r", b"\x07"),
        (b"x" * 100 + b"\rV\r", b"\x07V1013\r"),
    ],
)
def test_the_adapter_answers_as_the_manual_says(commands, answer):
    assert SlcanAdapter(bitrate=RATE).feed(commands) == answer


@pytest.mark.parametrize(("opening", "answer"), [(b"L\r", b"\x07"), (b"O\r", b"z\r")])
def test_every_request_to_transmit_is_counted(opening, answer):
    adapter = SlcanAdapter(bitrate=RATE)
    adapter.feed(b"S6\r" + opening)
    assert adapter.feed(b"t1230\r") == answer
    assert adapter.transmissions == 1


def test_a_channel_of_another_bit_rate_hears_nothing():
    adapter = SlcanAdapter(bitrate=RATE)
    adapter.feed(b"S8\rL\r")
    assert not adapter.forwards
    adapter.feed(b"C\rS6\rL\r")
    assert adapter.forwards


@given(chunks=st.lists(st.binary(max_size=60), max_size=10))
def test_the_adapter_takes_any_bytes(chunks):
    adapter = SlcanAdapter(bitrate=RATE)
    for chunk in chunks:
        adapter.feed(chunk)
    adapter.feed(b"\r")
    assert adapter.feed(b"V\r") == b"V1013\r"


def test_a_description_that_needs_can_fd_is_refused_since_the_adapter_is_classic():
    mapping = load_arm("rv4frl").can
    long = mapping.database_text.replace("JOINTS_1_2: 8", "JOINTS_1_2: 12")
    joints = [signal.joint for signal in mapping.joints]
    with pytest.raises(PlantError, match=r"at most 8 bytes, .* got 12 of JOINTS_1_2"):
        JointMessages(replace(mapping, database_text=long), joints)
