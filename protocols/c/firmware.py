"""Compile the boards of `ports/`: `python -m armodal.protocols.c.firmware`.

All are `ports/board.c`, the listing of docs/porting.md. `pty` runs as a program of this machine,
its link a pseudo-terminal, `an386` on an ARM Cortex-M4 in QEMU, as `mps2-an386`, its link the first
UART; their converter plays hits from a table. `stm32g474` is for a NUCLEO-G474RE with an ADS131M04
and IEPE supplies beside it. What is for a Cortex-M4 is compiled by `arm-none-eabi-gcc`, or by the
package `ziglang` where that is not there.
"""

from __future__ import annotations

import argparse
import importlib.util
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from armodal.protocols.c.build import HERE, INCLUDE, SOURCES, STRICT, CompilerError, compile_with
from armodal.protocols.c.build import compilers as host_compilers

__all__ = ["BOARDS", "build", "main", "options"]

PORTS = HERE / "ports"
FOLDER = HERE / "build" / "firmware"
BOARDS = ("pty", "an386", "stm32g474")
# A machine that is held up for long must not make the board drop its preview.
_PATIENT = "-DBSP_PREVIEW_FRAMES=64"
_FILES = {
    "pty": (PORTS / "table_adc.c",),
    "an386": (PORTS / "table_adc.c",),
    "stm32g474": tuple(PORTS / f"{name}.c" for name in ("ads131m04", "dma_link", "teds_wire")),
}
BAUD = 921_600  # what armodal opens a serial port with
_OF_BOARD = {
    "pty": (_PATIENT,),
    "an386": (_PATIENT,),
    "stm32g474": (
        *('-DBSP_BOARD_ID="nucleo-g474re"', "-DBSP_TICK_HZ=1024000u"),
        "-DBSP_GROUP_DELAY_SAMPLES=1.5",  # sinc3: 3 (R - 1) / 2 over R, R from 128 on
    ),
}
_LINKER_SCRIPTS = {"an386": "an386.ld", "stm32g474": "stm32g474re.ld"}
_ARM = ("-Os", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections")
_GCC = (
    *("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-nostartfiles"),
    "-specs=nosys.specs",
)
_ZIG = (
    *("-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m4+vfp4d16sp"),
    *("-Wl,--entry,reset", "-isystem", str(PORTS / "freestanding")),
)


def build(board: str, folder: Path = FOLDER, baud: int = BAUD) -> Path:
    """Compile a board of `BOARDS`; return the program, or the image for the microcontroller.

    Raises
    ------
    CompilerError
        If there is no compiler for it, or it refuses the sources.
    """
    program = folder / ("board-pty" if board == "pty" else f"board-{board}.elf")
    folder.mkdir(parents=True, exist_ok=True)
    files = [*SOURCES, PORTS / "board.c", *_FILES[board], *sorted((PORTS / board).glob("*.c"))]
    compiler, how = _host() if board == "pty" else _arm(board)
    arguments = [*STRICT, *how, *options(board, baud), f"-I{INCLUDE}", f"-I{PORTS}"]
    arguments += map(str, files)
    said = compile_with(compiler, arguments, program)
    if said:
        raise CompilerError(f"firmware {board}: the compiler refuses it: {said[:2000]}")
    return program


def options(board: str, baud: int = BAUD) -> tuple[str, ...]:
    """What a board tells the compiler of itself, wherever it is compiled."""
    link = () if board == "pty" else (f"-DBSP_BAUD={baud}u",)
    return (*_OF_BOARD[board], *link)


def _host() -> tuple[list[str], tuple[str, ...]]:
    """A compiler of programs for this machine, and its options."""
    found = next(host_compilers(), None)
    if found is None:
        raise CompilerError(
            "firmware pty: wanted a C compiler, found none: install gcc or clang, or the package "
            "ziglang with pip"
        )
    return found, ("-O2",)


def _arm(board: str) -> tuple[list[str], tuple[str, ...]]:
    """A compiler for the Cortex-M4, and its options."""
    script = ("-T", str(PORTS / board / _LINKER_SCRIPTS[board]))
    path = shutil.which("arm-none-eabi-gcc")
    if path is not None:
        return [path], (*_ARM, *script, *_GCC)
    if importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc"], (*_ARM, *script, *_ZIG)
    raise CompilerError(
        f"firmware {board}: wanted arm-none-eabi-gcc with newlib, found none: install the packages "
        "gcc-arm-none-eabi and libnewlib-arm-none-eabi, or the package ziglang with pip"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Compile the boards named, or all; exit code 2 where one cannot be."""
    parser = argparse.ArgumentParser(prog="armodal.protocols.c.firmware")
    # No `choices`: with them Python 3.11 refuses that none is named.
    parser.add_argument("board", nargs="*", help=f"of {', '.join(BOARDS)}; left out: all")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where programs are put")
    parser.add_argument("--baud", type=int, default=BAUD, help="of a UART, 9600 to 4000000")
    given = parser.parse_args(arguments)
    unknown = [name for name in given.board if name not in BOARDS]
    if unknown:
        parser.error(f"wanted boards of {', '.join(BOARDS)}, got {', '.join(unknown)}")
    if not 9600 <= given.baud <= 4_000_000:
        parser.error(f"--baud: wanted 9600 to 4000000, got {given.baud}")
    for board in given.board or BOARDS:
        sys.stdout.write(f"{board}: {build(board, given.folder, given.baud)}\n")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except CompilerError as error:
        sys.stderr.write(f"{error}\n")
        sys.exit(2)
