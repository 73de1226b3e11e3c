"""The driver of the converter, compiled for this machine, against a model of the chip."""

import subprocess

import numpy as np
import pytest
from cffi import FFI
from support.ads131m04_model import CLOCK, GAIN1, MODE, Ads131m04
from support.quick import every_nth

from armodal.protocols.c.build import HERE, STRICT, compilers
from armodal.protocols.c.library import declarations

PORTS = HERE / "ports"
OK, SILENT, CRC, REGISTER, FAULT = range(5)
PERIOD = 100  # ticks
SAMPLES = [(i, -i, 0x7FFFFF - i, -0x800000 + i) for i in range(1, 400)]


@pytest.fixture(scope="module")
def driver(tmp_path_factory):
    compiler = next(compilers(), None)
    if compiler is None:
        pytest.skip("no C compiler on this machine")
    library = tmp_path_factory.mktemp("ads") / "ads131m04.so"
    source = str(PORTS / "ads131m04.c")
    command = [*compiler, *STRICT, "-shared", "-fPIC", f"-I{PORTS}", source, "-o", str(library)]
    subprocess.run(command, check=True)
    ffi = FFI()
    ffi.cdef(declarations(PORTS / "ads131m04.h"))
    return ffi, ffi.dlopen(str(library))


def begin(driver, chip, *, osr=0, gains=(0, 0, 0, 0)):
    ffi, c = driver

    def transfer(_context, out, into, n):
        ffi.memmove(into, chip.transfer(bytes(ffi.buffer(out, n))), n)

    called = ffi.callback("void(void *, const uint8_t *, uint8_t *, size_t)", transfer)
    port = ffi.new("ads_port *", {"transfer": called})
    return c.ads_begin(port, osr, ffi.new("uint8_t[4]", gains))


class Fetched:
    """What interrupts do: a frame for every data-ready that is served; the first has been.

    `before` are counts of samples that wait in the chip when it is.
    """

    def __init__(self, driver, before=()):
        self.ffi, self.c = driver
        self.ring = self.ffi.new("ads_ring *")
        self.c.ads_ring_begin(self.ring, 256 * PERIOD)
        self.chip, self.at = Ads131m04(), 1_000 - PERIOD
        assert begin(driver, self.chip) == OK
        for counts in before:
            self.chip.sample(*counts)
        self.data_ready((0, 0, 0, 0))

    def data_ready(self, counts, *, served=True, flips=0, overtaken=None):
        """`overtaken` are the counts of a sample that is ready before the frame has begun, or,
        behind a "later", before the next frame has, where one follows at once."""
        self.at += PERIOD
        self.chip.sample(*counts)
        if not served:
            return
        at, due = self.at, None
        if overtaken is not None:
            due = overtaken[-4:]
            if overtaken[0] != "later":
                self.chip.sample(*due)
        while True:
            self.chip.flips = flips
            frame = self.chip.transfer(bytes(18))
            self.ffi.memmove(self.c.ads_ring_next(self.ring), frame, 18)
            if overtaken is not None and overtaken[0] == "later":
                self.chip.sample(*due)
                overtaken = due
            if not self.c.ads_ring_done(self.ring, at):
                break
        if due is not None:  # its interrupt was due; now it is served
            self.at += PERIOD
            frame = self.chip.transfer(bytes(18))
            self.ffi.memmove(self.c.ads_ring_next(self.ring), frame, 18)
            assert not self.c.ads_ring_done(self.ring, self.at)

    def read(self, most=64):
        """Samples, ticks of the first, and how many were lost before it."""
        counts = self.ffi.new("int32_t[]", 4 * most)
        ticks, lost = self.ffi.new("uint64_t *"), self.ffi.new("uint32_t *")
        n = self.c.ads_ring_read(self.ring, counts, most, ticks, lost)
        return [tuple(counts[4 * i : 4 * i + 4]) for i in range(n)], ticks[0], lost[0]


@pytest.fixture
def fetched(driver):
    return Fetched(driver)


def test_the_chip_is_set_up_and_read_back(driver):
    chip = Ads131m04()
    chip.registers[CLOCK] = 0x0123  # whatever it was left with
    assert begin(driver, chip, osr=2, gains=(0, 1, 2, 7)) == OK
    assert chip.commands[0] == 0x0011
    # All channels on, high resolution, OSR 512; words of 24 bits, the flag of the reset cleared.
    assert chip.registers[CLOCK] == 0x0F02 | 2 << 2
    assert chip.registers[MODE] == 0x0110
    assert chip.registers[GAIN1] == 0x7210


@pytest.mark.parametrize(
    ("chip", "result"),
    [
        (Ads131m04(dead=True), SILENT),
        (Ads131m04(id_register=0x2300), SILENT),
        (Ads131m04(sticks=CLOCK), REGISTER),
        (Ads131m04(sticks=GAIN1), OK),  # it holds 0 already
    ],
    ids=["dead", "three channels", "clock sticks", "gain as after reset"],
)
def test_a_chip_that_is_not_as_wanted_is_told(driver, chip, result):
    assert begin(driver, chip) == result


@pytest.mark.parametrize("bit", every_nth(range(8, 144), 5))
def test_any_bit_turned_over_is_seen(driver, bit):
    ffi, c = driver
    chip = Ads131m04()
    assert begin(driver, chip) == OK
    chip.sample(1, 2, 3, 4)
    chip.flips = 1 << bit
    frame = ffi.new("uint8_t[18]", chip.transfer(bytes(18)))
    assert c.ads_decode(frame, ffi.new("int32_t[4]")) == CRC


def test_samples_come_as_converted_with_the_ticks_of_the_first(fetched):
    for counts in SAMPLES[:10]:
        fetched.data_ready(counts)
    assert fetched.read() == (SAMPLES[:10], 1_000 + PERIOD, 0)
    assert fetched.read() == ([], 0, 0)
    fetched.data_ready(SAMPLES[10])
    assert fetched.read() == ([SAMPLES[10]], 1_000 + 11 * PERIOD, 0)


def test_what_waits_in_the_chip_at_the_start_makes_no_sample_late(driver):
    fetched = Fetched(driver, before=[(-1, -1, -1, -1)] * 2)
    for counts in SAMPLES[:5]:
        fetched.data_ready(counts)
    assert fetched.read() == (SAMPLES[:5], 1_000 + PERIOD, 0)


def test_no_more_come_than_asked_for(fetched):
    for counts in SAMPLES[:10]:
        fetched.data_ready(counts)
    assert fetched.read(4)[0] == SAMPLES[:4]
    assert fetched.read(64) == (SAMPLES[4:10], 1_000 + 5 * PERIOD, 0)


def test_a_bad_frame_is_a_lost_sample_before_the_next(fetched):
    for i, counts in enumerate(SAMPLES[:6]):
        fetched.data_ready(counts, flips=1 << 40 if i == 3 else 0)
    assert fetched.read() == (SAMPLES[:3], 1_000 + PERIOD, 0)
    assert fetched.read() == (SAMPLES[4:6], 1_000 + 5 * PERIOD, 1)
    assert fetched.ring.bad_frames == 1


def test_a_resynchronised_or_reset_chip_gives_no_samples(fetched):
    fetched.data_ready(SAMPLES[0])
    fetched.chip.resync = True
    fetched.data_ready(SAMPLES[1])
    fetched.chip.registers[MODE] |= 0x0400
    fetched.data_ready(SAMPLES[2])
    assert fetched.read()[0] == SAMPLES[:1]
    assert fetched.read() == ([], 0, 2)


def test_data_ready_that_nobody_served_is_counted_by_the_ticks(fetched):
    for i, counts in enumerate(SAMPLES[:9]):
        fetched.data_ready(counts, served=i not in (4, 5, 6))
    assert len(fetched.read()[0]) == 4
    # Two wait in the chip after a pause, and no ticks tell which is which: both are given up.
    assert fetched.read() == (SAMPLES[8:9], 1_000 + 9 * PERIOD, 4)


@pytest.mark.parametrize("later", [(), ("later",)])
@pytest.mark.parametrize("paused", [False, True])
def test_a_sample_that_overtakes_a_frame_keeps_its_place(fetched, later, paused):
    """The tick of every sample that is read is its own, whenever the next one became ready."""
    for i in range(12):
        served = not paused or i not in (4, 5)
        overtaken = (*later, *((2 * i + 2,) * 4)) if i in (0, 6) else None
        fetched.data_ready((2 * i + 1,) * 4, served=served, overtaken=overtaken)
    numbered = {1_000 + PERIOD: 1, 1_000 + 2 * PERIOD: 2}  # by ticks
    at = 1_000 + 2 * PERIOD
    for i in range(1, 12):
        at += PERIOD
        numbered[at] = 2 * i + 1
        if i == 6:
            at += PERIOD
            numbered[at] = 2 * i + 2
    told = 0
    while fetched.ring.read != fetched.ring.written:
        samples, ticks, lost = fetched.read()
        told += len(samples) + lost
        for place, counts in enumerate(samples):
            assert counts == (numbered[ticks + place * PERIOD],) * 4
    assert told == len(numbered)


def test_a_ring_that_is_not_emptied_loses_the_oldest_and_counts_them(fetched):
    for counts in SAMPLES[:200]:
        fetched.data_ready(counts)
    assert fetched.read(128) == (SAMPLES[200 - 63 : 200], 1_000 + 138 * PERIOD, 200 - 63)
    for counts in SAMPLES[200:300]:
        fetched.data_ready(counts)
    assert fetched.read(128) == (SAMPLES[300 - 63 : 300], 1_000 + 238 * PERIOD, 100 - 63)


def test_what_is_lost_and_what_comes_are_all_there_were(fetched):
    """Any way of serving, damaging and reading: the count of samples stays that of the ticks."""
    rng = np.random.default_rng(1)
    fetched.data_ready(SAMPLES[0])
    told = 0
    for i in range(1, 3000):
        served, flipped = rng.random() > 0.02, rng.random() < 0.01
        fetched.data_ready((i, i, i, i), served=served, flips=1 << 60 if flipped else 0)
        if rng.random() < 0.03:
            samples, _, lost = fetched.read(int(rng.integers(1, 200)))
            told += len(samples) + lost
    for _ in range(2):  # the first may find two in the chip
        fetched.data_ready((1, 1, 1, 1))
    while fetched.ring.read != fetched.ring.written:
        samples, _, lost = fetched.read(200)
        told += len(samples) + lost
    assert told == 3002
