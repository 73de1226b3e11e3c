"""Compile the device library for this machine: `python -m armodal.protocols.c.build`.

The system's C compiler is taken (`CC`, then cc, gcc, clang), else the one of the package
`ziglang`. The result lies beside the sources in `build/`, or in the user's cache where an
installation cannot be written, and is made again when they change.
"""

from __future__ import annotations

import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import platformdirs

from armodal import __version__
from armodal.protocols.errors import ArmodalError

__all__ = [
    "HEADERS",
    "INCLUDE",
    "LIBRARY",
    "SOURCES",
    "STRICT",
    "CompilerError",
    "compile_with",
    "compilers",
    "ensure_library",
    "is_current",
]

HERE = Path(__file__).resolve().parent
INCLUDE = HERE / "include"
HEADERS = tuple(INCLUDE / f"armodal_{name}.h" for name in ("messages", "board", "host"))
SOURCES = tuple(sorted((HERE / "src").glob("*.c")))
NAME = "libarmodal_board.so"
LIBRARY = (
    HERE / "build" / NAME
    if os.access(HERE, os.W_OK)
    else platformdirs.user_cache_path("armodal") / __version__ / NAME
)
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wshadow", "-pedantic")
_FAST = ("-O3", "-DAB_FAST_CRC=1", "-fPIC", "-shared")


class CompilerError(ArmodalError, RuntimeError):
    """There is no C compiler, or it refuses the sources."""


def compilers() -> Iterator[list[str]]:
    """Command lines of the C compilers that are there, the best first."""
    named = os.environ.get("CC")
    if named:
        yield shlex.split(named)
    for name in ("cc", "gcc", "clang"):
        found = shutil.which(name)
        if found:
            yield [found]
    if importlib.util.find_spec("ziglang") is not None:
        yield [sys.executable, "-m", "ziglang", "cc"]


def compile_with(compiler: Sequence[str], arguments: Sequence[str], output: Path) -> str:
    """Run one compiler; return what it complained of, nothing where it has made `output`."""
    # The command is composed of a compiler the user has and of names in this package.
    try:
        done = subprocess.run(  # noqa: S603
            [*compiler, *arguments, "-o", str(output)],
            capture_output=True,
            text=True,
            check=False,
        )
    except OSError as error:
        return str(error)
    return "" if done.returncode == 0 else done.stderr.strip() or f"exit code {done.returncode}"


def is_current() -> bool:
    """Whether the library is there and no source is newer."""
    inputs = [*SOURCES, *HEADERS, HERE / "src" / "internal.h", Path(__file__)]
    newest = max(path.stat().st_mtime_ns for path in inputs)
    return LIBRARY.is_file() and LIBRARY.stat().st_mtime_ns >= newest


def ensure_library() -> Path:
    """Compile the library unless it is there and current; return where it is.

    Raises
    ------
    CompilerError
        If it must be compiled and no compiler does it.
    """
    if is_current():
        return LIBRARY
    refused = []
    for compiler in compilers():
        said = _compile(compiler)
        if not said:
            return LIBRARY
        refused.append(f"{' '.join(compiler)}: {said[:2000]}")
    tried = "\n".join(refused) or "none found: CC, cc, gcc, clang, ziglang"
    raise CompilerError(
        "wanted the board's device library compiled for this machine, and no C compiler does "
        "it. Install gcc or clang, or the package ziglang with pip, and try again. Tried: "
        f"{tried}"
    )


def _compile(compiler: Sequence[str]) -> str:
    try:
        LIBRARY.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=LIBRARY.parent) as folder:
            # Renamed when whole: another process may be loading the library now.
            made = Path(folder) / LIBRARY.name
            sources = [str(path) for path in SOURCES]
            said = compile_with(compiler, [*STRICT, *_FAST, f"-I{INCLUDE}", *sources], made)
            if not said:
                made.replace(LIBRARY)
            return said
    except OSError as error:
        return f"cannot write {LIBRARY}: {error}"


def main() -> int:
    """Compile; where no compiler does it, install `ziglang` and try again."""
    try:
        ensure_library()
    except CompilerError:
        if importlib.util.find_spec("ziglang") is not None:
            raise
        sys.stderr.write("no C compiler on this machine: installing the package ziglang\n")
        install = [sys.executable, "-m", "pip", "install", "--quiet"]
        install += ["--disable-pip-version-check", "ziglang"]
        constraints = HERE.parents[1] / "constraints.txt"
        if constraints.is_file():
            install += ["--constraint", str(constraints)]
        # This interpreter's own pip, and a name fixed here.
        subprocess.run(install, check=True)  # noqa: S603
        importlib.invalidate_caches()
        ensure_library()
    sys.stdout.write(f"device library: {LIBRARY}\n")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (CompilerError, subprocess.CalledProcessError) as error:
        sys.stderr.write(f"armodal.protocols.c.build: {error}\n")
        sys.exit(2)
