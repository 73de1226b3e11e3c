"""The boards of `protocols/c/ports` are built and pass the check: on this machine and in QEMU."""

import re
import shutil
import subprocess
from contextlib import closing, contextmanager
from fractions import Fraction

import pytest

from armodal.daq.board_link import BoardLink
from armodal.daq.check import BOARD_STEPS, BoardCheckOptions, Verdict, check_board
from armodal.daq.clock import SystemClock
from armodal.daq.serial_port import SerialPort
from armodal.protocols.c.firmware import build
from armodal.protocols.c.sizes import CODE_LIMIT_BYTES, measure

needs_cc = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler on this machine")
needs_qemu = pytest.mark.skipif(
    shutil.which("qemu-system-arm") is None or shutil.which("arm-none-eabi-gcc") is None,
    reason="no qemu-system-arm or no arm-none-eabi-gcc on this machine",
)
BOARDS = [pytest.param("pty", marks=needs_cc), pytest.param("an386", marks=needs_qemu)]
QEMU = ["qemu-system-arm", "-M", "mps2-an386", "-display", "none", "-monitor", "none"]
OPTIONS = BoardCheckOptions(duration_s=1.0, rate_hz=Fraction(51_200, 8))


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    return tmp_path_factory.mktemp("firmware")


@contextmanager
def running(board, folder):
    """Yield the port of a board that has booted."""
    program = str(build(board, folder))
    command = [program] if board == "pty" else [*QEMU, "-serial", "pty", "-kernel", program]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            yield re.search(r"/dev/\S+", process.stdout.readline()).group()
        finally:
            process.kill()


def not_passed(report):
    return {step.name: step.came for step in report.steps if step.verdict is not Verdict.PASS}


@pytest.mark.parametrize("board", BOARDS)
def test_the_board_of_the_guide_answers_as_it_should(programs, board, real_time):
    with running(board, programs) as port:
        steps = ("dictionary", "rates", "commands", "version", "session")
        report = check_board(lambda: SerialPort(port), OPTIONS, only=steps)
    assert not_passed(report) == {}
    assert len(report.steps) == 5


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


@needs_qemu
def test_the_library_is_as_small_as_promised():
    sizes = measure()
    assert sizes.is_judged
    assert sizes.core_code <= CODE_LIMIT_BYTES
