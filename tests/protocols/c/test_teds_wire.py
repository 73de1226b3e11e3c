"""A sensor's memory is read over its line, compiled for this machine, against a model in time."""

import subprocess
from datetime import date

import pytest
from cffi import FFI
from support.one_wire_model import DS2430A, OneWireMemory, paged
from support.teds_bits import iepe

from armodal.protocols.c.build import HERE, STRICT, compilers
from armodal.protocols.c.library import declarations
from armodal.protocols.teds import decode_teds

PORTS = HERE / "ports"
SHEET = iepe(0.0102, calibrated=date(2026, 3, 2))
DS2431, DS2433, DS28EC20 = 0x2D, 0x23, 0x43
SIZES = {DS2431: 128, DS2433: 512, DS28EC20: 2560}
LATE_US = 3.0  # what a wait may take more, by teds_wire.h


@pytest.fixture(scope="module")
def driver(tmp_path_factory):
    compiler = next(compilers(), None)
    if compiler is None:
        pytest.skip("no C compiler on this machine")
    library = tmp_path_factory.mktemp("wire") / "teds_wire.so"
    source = str(PORTS / "teds_wire.c")
    command = [*compiler, *STRICT, "-shared", "-fPIC", f"-I{PORTS}", source, "-o", str(library)]
    subprocess.run(command, check=True)
    ffi = FFI()
    ffi.cdef(declarations(PORTS / "teds_wire.h"))
    return ffi, ffi.dlopen(str(library))


def read(driver, memory, *, size=128, late_us=0.0, turned_over_at=None, shorted=False):
    """Bytes that the driver reads of a memory; `turned_over_at` is a look at the line that errs."""
    ffi, c = driver
    line = {"t_us": 0.0, "down": False, "looks": 0}

    def pull(_context, down):
        if down != line["down"] and memory is not None:
            (memory.down if down else memory.up)(line["t_us"])
        line["down"] = down

    def is_up(_context):
        line["looks"] += 1
        held = shorted or (memory is not None and memory.holds(line["t_us"]))
        return (not (line["down"] or held)) != (line["looks"] == turned_over_at)

    def wait(_context, us):
        line["t_us"] += us + (late_us if us < 100 else 0.0)

    keep = [
        ffi.callback("void(void *, bool)", pull),
        ffi.callback("bool(void *)", is_up),
        ffi.callback("void(void *, uint32_t)", wait),
    ]
    wire = ffi.new("teds_wire *", {"pull": keep[0], "is_up": keep[1], "wait_us": keep[2]})
    into = ffi.new("uint8_t[]", size)
    return bytes(ffi.buffer(into, c.teds_wire_read(wire, into, size)))


@pytest.mark.parametrize("late_us", [0.0, LATE_US])
@pytest.mark.parametrize("family", SIZES)
def test_a_data_sheet_is_read_without_its_checksum_bytes(driver, family, late_us):
    memory = OneWireMemory(family, paged(SHEET).ljust(SIZES[family], b"\0"))
    got = read(driver, memory, late_us=late_us)
    assert got[: len(SHEET)] == SHEET
    assert decode_teds(got) == decode_teds(SHEET)


def test_the_basic_data_sheet_of_a_ds2430a_is_in_its_register(driver):
    memory = OneWireMemory(DS2430A, paged(SHEET[8:]), register=SHEET[:8])
    assert decode_teds(read(driver, memory)) == decode_teds(SHEET)


def test_no_sensor_a_short_and_another_memory_are_no_data_sheet(driver):
    assert read(driver, None) == b""
    memory = OneWireMemory(DS2431, paged(SHEET).ljust(128, b"\0"))
    assert read(driver, memory, shorted=True) == b""
    assert read(driver, OneWireMemory(0x28, bytes(128))) == b""  # a thermometer


@pytest.mark.parametrize("look", [1, 3, 40, 80, 200, 700, 1200])
def test_a_bit_read_wrong_is_no_data_sheet(driver, look):
    memory = OneWireMemory(DS2431, paged(SHEET).ljust(128, b"\0"))
    assert read(driver, memory, turned_over_at=look) == b""
