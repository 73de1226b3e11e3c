"""The boards of `protocols/c/ports` are built and pass the check: on this machine and in QEMU."""

import json
import math
import re
import shutil
import struct
import subprocess
import sys
from contextlib import closing, contextmanager
from fractions import Fraction
from functools import cache
from importlib.util import find_spec

import pytest
from support.at_the_end import at_the_end
from support.reach_plan import reach_text

from armodal.daq.board_link import BoardLink
from armodal.daq.check import BOARD_STEPS, BoardCheckOptions, Verdict, check_board
from armodal.daq.clock import SystemClock
from armodal.daq.serial_port import SerialPort
from armodal.protocols.c.firmware import BOARDS as BUILT
from armodal.protocols.c.firmware import build, main
from armodal.protocols.session.hdf5 import read_session

needs_cc = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler on this machine")
needs_qemu = pytest.mark.skipif(
    shutil.which("qemu-system-arm") is None or shutil.which("arm-none-eabi-gcc") is None,
    reason="no qemu-system-arm or no arm-none-eabi-gcc on this machine",
)
needs_gcc = pytest.mark.skipif(
    shutil.which("arm-none-eabi-gcc") is None, reason="no arm-none-eabi-gcc on this machine"
)
needs_zig = pytest.mark.skipif(
    shutil.which("qemu-system-arm") is None or find_spec("ziglang") is None,
    reason="no qemu-system-arm or no package ziglang on this machine",
)
BOARDS = [pytest.param("pty", marks=needs_cc), pytest.param("an386", marks=needs_qemu)]
ONE_QUICKLY = [BOARDS[0], pytest.param("an386", marks=[needs_qemu, pytest.mark.long])]
QEMU = ["qemu-system-arm", "-M", "mps2-an386", "-display", "none", "-monitor", "none"]
OPTIONS = BoardCheckOptions(duration_s=1.0, rate_hz=Fraction(51_200, 16))


built = cache(build)


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    return tmp_path_factory.mktemp("firmware")


@contextmanager
def running(board, folder):
    """Yield the port of a board that is compiled here and has booted."""
    with booted(board, str(built(board, folder))) as port:
        yield port


@contextmanager
def booted(board, program):
    """Yield the port of a board that has booted."""
    command = [program] if board == "pty" else [*QEMU, "-serial", "pty", "-kernel", program]
    with (
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process,
        at_the_end(f"kill {process.pid}"),
    ):
        yield re.search(r"/dev/\S+", process.stdout.readline()).group()


def not_passed(report):
    return {step.name: step.came for step in report.steps if step.verdict is not Verdict.PASS}


@pytest.mark.parametrize("board", ONE_QUICKLY)
def test_the_board_of_the_guide_answers_as_it_should(programs, board, real_time):
    with running(board, programs) as port:
        steps = ("dictionary", "rates", "commands", "version", "session")
        report = check_board(lambda: SerialPort(port), OPTIONS, only=steps)
    assert not_passed(report) == {}
    assert len(report.steps) == 5


@pytest.mark.long
@needs_zig
def test_the_board_answers_as_well_when_ziglang_has_compiled_it(tmp_path, monkeypatch, real_time):
    with monkeypatch.context() as patch:
        patch.setattr("armodal.protocols.c.firmware.shutil.which", lambda name: None)
        program = build("an386", tmp_path)
    assert b"LLD" in program.read_bytes()  # the linker that ziglang brings
    with booted("an386", str(program)) as port:
        steps = ("dictionary", "rates", "commands")
        report = check_board(lambda: SerialPort(port), OPTIONS, only=steps)
    assert not_passed(report) == {}
    assert len(report.steps) == 3


@pytest.mark.long
@needs_qemu
def test_two_boots_have_two_sessions(programs):
    sessions = []
    for _ in range(2):
        with running("an386", programs) as name, closing(SerialPort(name)) as port:
            sessions.append(BoardLink(port, SystemClock()).hello().session)
    assert sessions[0] != sessions[1]


@pytest.mark.long
@pytest.mark.parametrize("board", BOARDS)
def test_the_board_of_the_guide_passes_every_step(programs, board, real_time):
    with running(board, programs) as port:
        report = check_board(lambda: SerialPort(port), OPTIONS)
    assert not_passed(report) == {}
    assert len(report.steps) == len(BOARD_STEPS)


@pytest.mark.long
@pytest.mark.parametrize("board", BOARDS[1:])
def test_a_session_by_hand_with_the_board_of_the_guide(programs, board, tmp_path, real_time):
    """An arm without [can], a board in QEMU, a person who confirms: hits of the table, accepted."""
    plan = reach_text(
        rate_hz="51200/31", samples=1024, pretrigger=100, points=["2"], hits=2, attempts=4
    )
    (tmp_path / "plan.toml").write_text(plan, encoding="utf-8")
    files = {name: str(tmp_path / name) for name in ("plan.toml", "ur5.journal")}
    with running(board, programs) as port:
        command = [sys.executable, "-m", "armodal.tui.cli", "acquire", files["plan.toml"]]
        command += ["--arm", "ur5", "--board", port, "--by-hand", "0.2", "--json"]
        done = subprocess.run(
            [*command, "--journal", files["ur5.journal"]],
            input="40\n15 -30.2 40 -60 -70 20\n\n",  # too few, then all, then mounted
            capture_output=True,
            text=True,
            check=False,
        )
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["complete"]
    assert said["hits"]["accepted"] == 2
    assert "wanted 6 joint angles, got 1" in done.stderr + done.stdout
    session = read_session(said["session"])
    assert session.header.told_tolerance_rad == pytest.approx(math.radians(0.2))
    for hit in session.accepted():
        assert math.degrees(hit.before.joints_rad[1]) == pytest.approx(-30.2)
        # Half a sample off the top of a push of five samples: cos(pi / 10); noise 0.6 N.
        assert 250.0 * math.cos(math.pi / 10) - 0.6 < hit.verdict.peak_n < 250.6


def test_boards_are_built_by_name_and_all_without_one(tmp_path, monkeypatch, capsys):
    built = []
    monkeypatch.setattr(
        "armodal.protocols.c.firmware.build", lambda board, folder, baud: built.append(board)
    )
    assert main([]) == 0
    assert built == list(BUILT)
    assert main(["an386"]) == 0
    assert built[-1] == "an386"
    with pytest.raises(SystemExit) as ended:
        main(["an385"])
    assert ended.value.code == 2
    assert f"wanted boards of {', '.join(BUILT)}, got an385" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["stm32g474", "--baud", "300"])
    assert "--baud: wanted 9600 to 4000000, got 300" in capsys.readouterr().err


@needs_gcc
def test_the_board_with_an_stm32_fits_its_chip_and_its_vectors_point_at_its_interrupts(tmp_path):
    program = build("stm32g474", tmp_path)
    image = tmp_path / "board.bin"
    subprocess.run(["arm-none-eabi-objcopy", "-O", "binary", program, image], check=True)
    told = subprocess.run(
        ["arm-none-eabi-nm", program], capture_output=True, text=True, check=True
    ).stdout
    symbols = {name: int(at, 16) for at, _, name in map(str.split, told.splitlines())}
    vectors = struct.unpack("<118I", image.read_bytes()[: 4 * 118])
    assert vectors[0] == 0x2000_0000 + 128 * 1024
    handlers = {1: "reset", 16 + 11: "on_dma_converter", 16 + 13: "on_dma_link_in",
                16 + 14: "on_dma_link_out", 16 + 28: "on_tim2"}  # fmt: skip
    for place, name in handlers.items():
        assert vectors[place] == symbols[name] | 1, name  # Thumb
    assert len(image.read_bytes()) < 512 * 1024
    sram1_end = 0x2000_0000 + 80 * 1024
    assert all(symbols[name] < sram1_end for name in ("ring", "in", "out"))  # for DMA
    assert symbols["bss_end"] < 0x2000_0000 + 120 * 1024  # 8 KB for the stack


@pytest.mark.skipif(find_spec("ziglang") is None, reason="no package ziglang on this machine")
def test_ziglang_compiles_the_board_with_an_stm32_too(tmp_path, monkeypatch):
    monkeypatch.setattr("armodal.protocols.c.firmware.shutil.which", lambda name: None)
    program = build("stm32g474", tmp_path).read_bytes()
    entry, headers_at = struct.unpack_from("<II", program, 24)  # of an ELF file of 32 bits
    at, address = struct.unpack_from("<II", program, headers_at + 4)
    assert address == 0x0800_0000
    stack, reset = struct.unpack_from("<II", program, at)
    assert stack == 0x2000_0000 + 128 * 1024
    assert reset == entry
    assert reset & 1  # Thumb
