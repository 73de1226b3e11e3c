"""Compile the boards of `ports/`: `python -m armodal.protocols.c.firmware`.

Both are `ports/board.c`, the listing of docs/porting.md, with a converter that plays hits from a
table. `pty` runs as a program of this machine, its link a pseudo-terminal; `an386` runs on an ARM
Cortex-M4 and in QEMU as `mps2-an386`, its link the first UART. `an386` is compiled by
`arm-none-eabi-gcc`, or by the package `ziglang` where that is not there.
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

__all__ = ["BOARDS", "build", "main"]

PORTS = HERE / "ports"
FOLDER = HERE / "build" / "firmware"
BOARDS = ("pty", "an386")
# A machine that is held up for long must not make the board drop its preview.
_PREVIEW = "-DBSP_PREVIEW_FRAMES=64"
_ARM = (
    *("-Os", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections"),
    *("-T", str(PORTS / "an386" / "an386.ld")),
    "-DBSP_LINK_BYTES_PER_S=92160u",  # of a UART at 921600 baud: each byte costs the emulator
)
_GCC = (
    *("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-nostartfiles"),
    "-specs=nosys.specs",
)
_ZIG = (
    *("-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m4+vfp4d16sp"),
    *("-Wl,--entry,reset", "-isystem", str(PORTS / "freestanding")),
)


def build(board: str, folder: Path = FOLDER) -> Path:
    """Compile a board of `BOARDS`; return the program, or the image for the microcontroller.

    Raises
    ------
    CompilerError
        If there is no compiler for it, or it refuses the sources.
    """
    program = folder / ("board-pty" if board == "pty" else "board-an386.elf")
    folder.mkdir(parents=True, exist_ok=True)
    files = [*SOURCES, PORTS / "board.c", PORTS / "table_adc.c"]
    files += sorted((PORTS / board).glob("*.c"))
    compiler, options = _host() if board == "pty" else _arm()
    arguments = [*STRICT, *options, _PREVIEW, f"-I{INCLUDE}", f"-I{PORTS}", *map(str, files)]
    said = compile_with(compiler, arguments, program)
    if said:
        raise CompilerError(f"firmware {board}: the compiler refuses it: {said[:2000]}")
    return program


def _host() -> tuple[list[str], tuple[str, ...]]:
    """A compiler of programs for this machine, and its options."""
    found = next(host_compilers(), None)
    if found is None:
        raise CompilerError(
            "firmware pty: wanted a C compiler, found none: install gcc or clang, or the package "
            "ziglang with pip"
        )
    return found, ("-O2",)


def _arm() -> tuple[list[str], tuple[str, ...]]:
    """A compiler for the Cortex-M4, and its options."""
    path = shutil.which("arm-none-eabi-gcc")
    if path is not None:
        return [path], (*_ARM, *_GCC)
    if importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc"], (*_ARM, *_ZIG)
    raise CompilerError(
        "firmware an386: wanted arm-none-eabi-gcc with newlib, found none: install the packages "
        "gcc-arm-none-eabi and libnewlib-arm-none-eabi, or the package ziglang with pip"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Compile the boards named, or all; exit code 2 where one cannot be."""
    parser = argparse.ArgumentParser(prog="armodal.protocols.c.firmware")
    parser.add_argument("board", nargs="*", choices=BOARDS, default=list(BOARDS))
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where programs are put")
    given = parser.parse_args(arguments)
    for board in given.board:
        sys.stdout.write(f"{board}: {build(board, given.folder)}\n")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except CompilerError as error:
        sys.stderr.write(f"{error}\n")
        sys.exit(2)
