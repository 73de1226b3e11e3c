"""A UART by DMA, compiled for this machine, against a model of its counter and interrupts."""

import shutil
import subprocess

import pytest
from cffi import FFI
from hypothesis import given
from hypothesis import strategies as st
from support.uart_dma_model import UartDma

from armodal.protocols.c.build import HERE, STRICT, compilers
from armodal.protocols.c.library import declarations

PORTS = HERE / "ports"
RING, OUT = 16, 8


@pytest.fixture(scope="module")
def driver(tmp_path_factory):
    compiler = next(compilers(), None)
    if compiler is None:
        pytest.skip("no C compiler on this machine")
    library = tmp_path_factory.mktemp("dma") / "dma_link.so"
    source = str(PORTS / "dma_link.c")
    command = [*compiler, *STRICT, "-shared", "-fPIC", f"-I{PORTS}", source, "-o", str(library)]
    subprocess.run(command, check=True)
    ffi = FFI()
    ffi.cdef(declarations(PORTS / "dma_link.h"))
    return ffi, ffi.dlopen(str(library))


def uart(driver):
    return UartDma(*driver, ring_size=RING, out_size=OUT)


def numbered(first, n):
    """Bytes that tell their place."""
    return bytes((first + i) % 251 for i in range(n))


@given(steps=st.lists(st.tuples(st.integers(0, RING), st.integers(0, 40)), max_size=40))
def test_bytes_that_are_fetched_in_time_come_once_and_in_order(driver, steps):
    line = uart(driver)
    came = read = 0
    for offered, wanted in steps:
        n = min(offered, RING - (came - read))  # who reads in time leaves room for what comes
        line.receive(numbered(came, n))
        came += n
        got = line.read(wanted)
        assert got == numbered(read, min(wanted, came - read))
        read += len(got)
    assert line.link.overruns == 0


def test_a_lap_whose_interrupt_is_still_due_is_no_loss(driver):
    line = uart(driver)
    line.receive(numbered(0, RING - 2))
    assert line.read(100) == numbered(0, RING - 2)
    line.delay = True
    line.receive(numbered(RING - 2, 5))
    assert line.read(3) == numbered(RING - 2, 3)
    line.interrupt()
    assert line.read(100) == numbered(RING + 1, 2)
    line.delay = False
    line.receive(numbered(RING + 3, RING))
    assert line.read(100) == numbered(RING + 3, RING)
    assert line.link.overruns == 0


@given(late=st.integers(RING + 1, 5 * RING), after=st.integers(1, RING))
def test_who_reads_too_late_loses_bytes_is_told_and_goes_on(driver, late, after):
    line = uart(driver)
    line.receive(numbered(0, late))
    assert line.read(100) == b""
    assert line.link.overruns == 1
    line.receive(numbered(late, after))
    assert line.read(100) == numbered(late, after)
    assert line.link.overruns == 1


@given(steps=st.lists(st.tuples(st.integers(0, 20), st.integers(0, 20)), max_size=40))
def test_what_was_taken_goes_out_once_and_in_order(driver, steps):
    line = uart(driver)
    taken = 0
    for offered, gone in steps:
        n = line.write(numbered(taken, offered))
        # All that fits is taken, and no more: what is under way keeps its room.
        assert n == min(
            offered, OUT - (taken - len(line.line) + line.gone * (line.memory is not None))
        )
        taken += n
        line.transmit(gone)
    line.transmit(1000)
    assert bytes(line.line) == numbered(0, taken)


def test_a_long_run_of_the_sending_counter_wraps_without_harm(driver):
    line = uart(driver)
    line.link.queued = line.link.sent = 2**32 - 5
    assert line.write(numbered(0, OUT)) == OUT
    line.transmit(3)
    assert line.write(b"x") == 0  # the transfer under way keeps its room to its end
    line.transmit(100)
    assert bytes(line.line) == numbered(0, OUT)


def test_it_compiles_for_a_microcontroller_into_less_than_a_kilobyte(tmp_path):
    compiler, size = shutil.which("arm-none-eabi-gcc"), shutil.which("arm-none-eabi-size")
    if compiler is None or size is None:
        pytest.skip("no arm-none-eabi-gcc on this machine")
    made = tmp_path / "dma_link.o"
    options = [*STRICT, "-Os", "-mcpu=cortex-m4", "-mthumb", "-ffreestanding", "-c"]
    subprocess.run([compiler, *options, str(PORTS / "dma_link.c"), "-o", str(made)], check=True)
    told = subprocess.run([size, str(made)], capture_output=True, text=True, check=True).stdout
    text, data, bss = map(int, told.splitlines()[1].split()[:3])
    assert text < 1024
    assert data + bss == 0
