"""Code and RAM of the device library on a microcontroller: `python -m armodal.protocols.c.sizes`.

Compiled with -Os and the small CRC table, by `arm-none-eabi-gcc` for a Cortex-M4 where it is
there, and held against the limits. Else by gcc for 32-bit x86, whose code takes half as much room
again, or for the machine itself: to compare one version with another, not with the limits.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from armodal.protocols.c.build import INCLUDE, SOURCES, STRICT, CompilerError, compile_with

__all__ = ["CODE_LIMIT_BYTES", "RAM_LIMIT_BYTES", "Sizes", "main", "measure"]

CODE_LIMIT_BYTES = 8 * 1024
RAM_LIMIT_BYTES = 2 * 1024

# Needed by hosts only, and by boards that do not lay out their dictionary beforehand.
OPTIONAL = ("host", "host_messages", "dictionary_encode")

# Options, and what they compile for. 32-bit x86 needs no C library: nothing is linked.
_LEAN = ("-Os", "-ffreestanding", "-fno-pie", "-fno-asynchronous-unwind-tables", "-c")
_TARGETS = (
    ("arm-none-eabi-", ("-mcpu=cortex-m4", "-mthumb"), "ARM Cortex-M4"),
    ("", ("-m32",), "32-bit x86"),
    ("", (), "this machine"),
)

# The RAM of a board with four channels, as variables of a size that `size` reports.
_RAM = {
    "ab_board": "sizeof(ab_board)",
    "receive buffer": "AB_RECEIVE_BYTES",
    "transmit buffer": "AB_TRANSMIT_BYTES(4u)",
    "preview of one frame": "AB_PREVIEW_BYTES(4u, 1u)",
    "each block held": "sizeof(ab_block)",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Sizes:
    """Bytes of code by source file, and of RAM by purpose, for one kind of machine."""

    target: str
    is_judged: bool
    code: dict[str, int]
    ram: dict[str, int]

    @property
    def core_code(self) -> int:
        """Code of all that every board needs."""
        return sum(size for name, size in self.code.items() if name not in OPTIONAL)

    @property
    def core_ram(self) -> int:
        """RAM of a board with four channels that holds one block, beside the block buffer."""
        return sum(self.ram.values())


def _section_bytes(tool: str, objects: Sequence[Path]) -> Iterator[tuple[int, int]]:
    """Code with constants, and RAM, of each object file."""
    command = [tool, *map(str, objects)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)  # noqa: S603 - own objects
    for line in done.stdout.splitlines()[1:]:
        text, data, bss = map(int, line.split()[:3])
        yield text + data, data + bss


def _measure(prefix: str, options: Sequence[str], target: str, folder: Path) -> Sizes | None:
    compiler, tool = shutil.which(f"{prefix}gcc"), shutil.which(f"{prefix}size")
    if compiler is None or tool is None:
        return None
    sources = list(SOURCES)
    for i, size in enumerate(_RAM.values()):
        sources.append(folder / f"ram_{i}.c")
        text = f'#include "armodal_board.h"\nextern char ram[{size}];\nchar ram[{size}];\n'
        sources[-1].write_text(text, encoding="utf-8")
    objects = [folder / f"{source.stem}.o" for source in sources]
    for source, made in zip(sources, objects, strict=True):
        arguments = [*STRICT, *_LEAN, *options, f"-I{INCLUDE}", str(source)]
        if compile_with([compiler], arguments, made):
            return None
    found = list(_section_bytes(tool, objects))
    n_code = len(SOURCES)
    return Sizes(
        is_judged=prefix != "",
        target=f"{Path(compiler).name} {' '.join(['-Os', *options])}: {target}",
        code={s.stem: code for s, (code, _) in zip(SOURCES, found[:n_code], strict=True)},
        ram={name: ram for name, (_, ram) in zip(_RAM, found[n_code:], strict=True)},
    )


def measure() -> Sizes:
    """Compile for the smallest kind of machine that a compiler here knows.

    Raises
    ------
    CompilerError
        If there is no gcc with its `size`.
    """
    for prefix, options, target in _TARGETS:
        with tempfile.TemporaryDirectory() as folder:
            sizes = _measure(prefix, options, target, Path(folder))
        if sizes is not None:
            return sizes
    raise CompilerError(
        "sizes: wanted gcc or arm-none-eabi-gcc with its tool size, and found neither: install "
        "the package gcc-arm-none-eabi or gcc"
    )


def main() -> int:
    """Print sizes; exit code 1 where a limit is passed."""
    sizes = measure()
    lines = [sizes.target, "", "code and constants, small CRC table"]
    lines += [f"  {size:6d} B  {name}.c" for name, size in sizes.code.items() if size]
    optional = ", ".join(f"{name}.c" for name in OPTIONAL)
    judged = (
        ("", "")
        if not sizes.is_judged
        else tuple(f" (limit {limit} B)" for limit in (CODE_LIMIT_BYTES, RAM_LIMIT_BYTES))
    )
    lines += [
        f"  {sizes.core_code:6d} B  without {optional}{judged[0]}",
        "  without what the compiler's own library adds: 64-bit division, memcpy",
        "",
        "RAM beside the block buffer, four channels, without stack",
        *(f"  {size:6d} B  {name}" for name, size in sizes.ram.items()),
        f"  {sizes.core_ram:6d} B  with one block held{judged[1]}",
    ]
    sys.stdout.write("\n".join(lines) + "\n")
    within = sizes.core_code <= CODE_LIMIT_BYTES and sizes.core_ram <= RAM_LIMIT_BYTES
    return int(sizes.is_judged and not within)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except CompilerError as error:
        sys.stderr.write(f"{error}\n")
        sys.exit(2)
