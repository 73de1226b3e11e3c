"""The porting guide's figures are those of `protocols.board.limits`, its listing is a file's."""

import re
from fractions import Fraction
from pathlib import Path

from armodal.daq.check import BOARD_STEPS, CAN_STEPS
from armodal.protocols.board.codec import wire_size
from armodal.protocols.board.limits import (
    block_bytes,
    block_wire_bytes,
    samples_per_frame,
    stream_bytes_per_s,
)
from armodal.protocols.board.records import Configuration, Slope

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs" / "porting.md").read_text(encoding="utf-8")
# Ten bit times a byte; what USB stacks reach; 19 bulk packets of 64 bytes a millisecond.
LINKS = (921_600 // 10, 3_000_000 // 10, 800_000, 19 * 64 * 1000)


def configuration(n_channels, *, rate_hz=Fraction(1), length=1):
    return Configuration(
        rate_hz=rate_hz,
        channel_mask=(1 << n_channels) - 1,
        trigger_channel=0,
        trigger_level_counts=1,
        slope=Slope.RISING,
        pretrigger=0,
        block_length=length,
        stream=True,
    )


def rows(marker):
    part = GUIDE.split(f"<!-- {marker}")[1].split("<!-- end")[0]
    lines = [line for line in part.splitlines() if line.startswith("| ")][1:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def thousands(number):
    return f"{number:,}".replace(",", " ")


def test_the_rates_that_fit_a_link_are_those_of_the_limits():
    wanted = []
    for n_channels in (1, 2, 3, 4, 8, 16, 32):
        n = samples_per_frame(n_channels)
        data = 3 * n_channels * n
        per_hz = stream_bytes_per_s(configuration(n_channels))
        overhead = 100.0 * (wire_size(4 + data) / data - 1.0)
        rates = [f"{thousands(int(link / per_hz))} Hz" for link in LINKS]
        wanted.append(
            [str(n_channels), str(n), str(wire_size(4 + data)), f"{overhead:.1f} %", *rates]
        )
    assert rows("link arithmetic") == wanted


def test_the_blocks_take_as_long_as_the_limits_say():
    wanted = []
    for n_channels, length in ((2, 2048), (4, 2048), (4, 8192), (4, 65_536)):
        block = configuration(n_channels, length=length)
        wire = block_wire_bytes(block)
        times = [f"{wire / link:.2f} s" for link in LINKS[:3]]
        name = f"{n_channels} channels x {length}"
        wanted.append([name, thousands(block_bytes(block)), thousands(wire), *times])
    assert rows("block arithmetic") == wanted


def test_the_udev_rules_shown_are_those_of_the_file():
    shown = (ROOT / "docs" / "can-listen-only.md").read_text(encoding="utf-8")
    rules = (ROOT / "protocols" / "udev" / "70-armodal.rules").read_text(encoding="utf-8")
    lines = [line for line in rules.splitlines() if not line.startswith("#")]
    assert "\n".join(f"    {line}" for line in lines) in shown


def test_every_step_is_explained():
    for step in (*BOARD_STEPS, *CAN_STEPS):
        assert f"| `{step.name}` |" in GUIDE


def test_every_function_named_is_in_the_header():
    header = (ROOT / "protocols" / "c" / "include" / "armodal_board.h").read_text(encoding="utf-8")
    named = set(re.findall(r"\bab_[a-z_]+\b", GUIDE))
    assert named
    assert {name for name in named if not re.search(rf"\b{name}\b", header)} == set()


def test_the_listing_is_the_file_that_is_compiled():
    listing = GUIDE.split("```c\n")[1].split("```")[0]
    assert listing == (ROOT / "protocols" / "c" / "ports" / "board.c").read_text(encoding="utf-8")
