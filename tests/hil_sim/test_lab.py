import os
import signal
import stat
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from support import synthetic_laboratory
from support.host_side import DEADLINE_S
from support.synthetic_laboratory import PEAK_COUNTS, ramp

from armodal.hil_sim.__main__ import main
from armodal.hil_sim.lab import launch
from armodal.hil_sim.ledger import read_ledger
from armodal.protocols.board.messages import (
    decode_answer,
    decode_payload,
    decode_reply,
    decode_samples,
    encode_payload,
)
from armodal.protocols.board.records import (
    BlockInfo,
    BoardStatus,
    Configuration,
    FrameType,
    Release,
    ReplyCode,
    Slope,
)
from armodal.protocols.errors import DeviceLostError, PlantError
from armodal.protocols.slcan import CanFrame, SlcanParser, listen_only_commands

CONFIGURATION = Configuration(
    rate_hz=Fraction(51_200, 31),
    channel_mask=0b1111,
    trigger_channel=0,
    trigger_level_counts=PEAK_COUNTS // 10,
    slope=Slope.RISING,
    pretrigger=100,
    block_length=2048,
    stream=True,
)


def test_device_clock_and_lab_clock_differ_by_the_ppm(known_laboratory):
    board = known_laboratory.board()
    board.ask(FrameType.HELLO)
    pairs = []
    for _ in range(40):
        before = time.monotonic()
        reply = board.ask(FrameType.STATUS)
        after = time.monotonic()
        decode_answer(BoardStatus, reply.payload)
        pairs.append((before, reply.header.ticks, after))
    # Ticks lie within each round trip, at 1 MHz lab time from a common offset; 37 ppm and 1 tick
    # allowed for.
    low = max(t / 1e6 - 8.0 * after for _, t, after in pairs)
    high = min(t / 1e6 - 8.0 * before for before, t, _ in pairs)
    span_s = 8.0 * (pairs[-1][2] - pairs[0][0])
    assert high - low > -(37e-6 * span_s + 1e-6)


def test_the_bus_runs_at_lab_time(known_laboratory):
    can = known_laboratory.can()
    for command in listen_only_commands(500_000):
        can.write(command)
        assert can.read_until(lambda got: got.startswith(b"\r"))
    parser, frames = SlcanParser(), []
    begin = time.monotonic()
    while len(frames) < 1500:
        assert time.monotonic() < begin + DEADLINE_S
        frames += [f for f in parser.feed(can.read()) if isinstance(f, CanFrame)]
    # 500 cycles of 3 frames take 4 lab seconds; a machine that is late can only make it longer,
    # and the frames of one turn of the loop come together.
    assert time.monotonic() - begin > 0.9 * 4.0 / 8.0
    assert parser.faults == 0


def test_directory_and_socket_are_private(known_laboratory):
    laboratory = known_laboratory.laboratory
    assert stat.S_IMODE(laboratory.operator.parent.stat().st_mode) == 0o700
    assert stat.S_IMODE(laboratory.operator.stat().st_mode) == 0o600


def test_a_hit_goes_from_the_operator_through_the_board_to_the_host(known_laboratory):
    """The last that is done with it: it is ended here."""
    running = known_laboratory
    board, operator = running.board(), running.operator()
    board.ask(FrameType.HELLO)
    for kind, payload in (
        (FrameType.CONFIGURE, encode_payload(CONFIGURATION)),
        (FrameType.START, b""),
    ):
        assert decode_reply(board.ask(kind, payload).payload)[0] is ReplyCode.OK
    assert operator.ask(do="posture", name="p", joints_deg=[20, 0, 0, 0, 0, 0])["done"]
    assert operator.ask(do="mount", point="3")["done"]
    assert operator.ask(do="hit", point="1", direction=[0, 0, -1])["done"]
    board.until(lambda: board.of(FrameType.BLOCK_READY))
    info = decode_payload(BlockInfo, board.of(FrameType.BLOCK_READY)[0].payload)
    # 2048 samples are 32 frames.
    board.until(lambda: len(board.of(FrameType.BLOCK_DATA)) == 32)
    counts = np.concatenate([decode_samples(f).counts for f in board.of(FrameType.BLOCK_DATA)])
    np.testing.assert_array_equal(counts[:, 1:], ramp(info.first_sample, 2048))
    assert (
        decode_reply(board.ask(FrameType.RELEASE, encode_payload(Release(block_id=1))).payload)[0]
        is ReplyCode.OK
    )
    running.laboratory.close()
    assert not running.laboratory.alive
    assert not running.laboratory.operator.exists()
    running.laboratory.close()
    record = read_ledger(running.laboratory.ledger)
    (hit,) = record.of("hit")
    # The trigger is the first sample beyond a tenth of the half sine of 20 samples.
    assert info.trigger_sample == int(np.ceil(hit["at_sample"] + 20 * np.arcsin(0.1) / np.pi))
    assert hit["sensor_point"] == "3"
    (end,) = record.of("end")
    assert end["can_transmissions"] == 0


def test_the_laboratory_ends_when_its_parent_dies(tmp_path):
    script = Path(synthetic_laboratory.__file__)
    parent = (
        "import os, sys; from armodal.hil_sim.lab import launch\n"
        "lab = launch([sys.executable, *sys.argv[1:]])\n"
        "print(lab.pid, flush=True); os._exit(1)"
    )
    command = [sys.executable, "-c", parent, str(script), "--directory", str(tmp_path / "lab")]
    done = subprocess.run([*command, "--watch-stdin"], capture_output=True, check=False)
    pid = int(done.stdout)
    end = time.monotonic() + DEADLINE_S
    while _runs(pid):
        assert time.monotonic() < end
        time.sleep(0.01)
    assert not (tmp_path / "lab" / "operator.sock").exists()


@pytest.mark.long
def test_a_laboratory_that_is_being_made_ends_with_its_parent(tmp_path):
    making = (
        "import sys, threading; import armodal.hil_sim.__main__ as program\n"
        "program.load_plant = lambda _name: threading.Event().wait()\n"
        "program.main(sys.argv[1:])"
    )
    command = [sys.executable, "-c", making, "--directory", str(tmp_path / "lab"), "--watch-stdin"]
    assert subprocess.run(command, stdin=subprocess.DEVNULL, check=False).returncode == 1


def _runs(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    # Where nobody reaps it, a process that has ended stays as a zombie.
    status = Path(f"/proc/{pid}/stat")
    return not status.exists() or status.read_text().rsplit(")", 1)[1].split()[0] != "Z"


@pytest.mark.long
def test_sigterm_ends_the_laboratory_cleanly(start_known_laboratory):
    laboratory = start_known_laboratory().laboratory
    os.kill(laboratory.pid, signal.SIGTERM)
    laboratory.wait()
    assert not laboratory.alive
    assert len(read_ledger(laboratory.ledger).of("end")) == 1


@pytest.mark.long
def test_an_unknown_fault_is_refused_by_its_own_message(start_known_laboratory):
    with pytest.raises(PlantError, match="wanted a fault the laboratory knows"):
        start_known_laboratory(faults=["flood"])


def test_a_process_that_is_no_laboratory_is_told():
    with pytest.raises(DeviceLostError, match="ended by itself with exit code 3"):
        launch([sys.executable, "-c", "raise SystemExit(3)"])


def test_a_plant_that_does_not_exist_is_refused(tmp_path, capsys):
    given = ["--plant", str(tmp_path / "none.toml"), "--directory", str(tmp_path / "lab")]
    assert main(given) == 2
    assert "found none; check the path" in capsys.readouterr().err


def test_what_a_laboratory_refuses_to_start_with_is_told_in_its_words():
    refusing = "import sys; sys.stderr.write('hil_sim: no plant'); sys.exit(2)"
    with pytest.raises(PlantError, match=r"^no plant$"):
        launch([sys.executable, "-c", refusing])


def test_a_signal_while_the_process_is_made_ends_it_too(monkeypatch):
    made = []

    class Late(subprocess.Popen):
        """A process that is there before anyone can name it."""

        def __init__(self, *args, **more):
            super().__init__(*args, **more)
            made.append(self)
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(0)  # where Python would act on it

    def leave(number, _):
        raise SystemExit(128 + number)

    monkeypatch.setattr(subprocess, "Popen", Late)
    before = signal.signal(signal.SIGTERM, leave)
    try:
        with pytest.raises(SystemExit):
            launch([sys.executable, "-c", "input()"])
        assert signal.getsignal(signal.SIGTERM) is leave
    finally:
        signal.signal(signal.SIGTERM, before)
    (process,) = made
    assert process.poll() == -signal.SIGTERM
