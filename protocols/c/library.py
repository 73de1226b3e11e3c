"""The compiled device library in this process, its declarations read from the C header itself."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

from cffi import FFI

from armodal.protocols.c.build import HEADERS, ensure_library

__all__ = ["declarations", "device_library"]


def declarations(header: Path) -> str:
    """C declarations of a header without its preprocessor lines."""
    text = re.sub(r"/\*.*?\*/", "", header.read_text(encoding="utf-8"), flags=re.DOTALL)
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return "\n".join(lines)


@cache
def device_library() -> tuple[Any, Any]:
    """Return cffi's `ffi` and the library, compiled at first use if need be.

    Raises
    ------
    CompilerError
        If it must be compiled and there is no compiler.
    """
    path = ensure_library()
    ffi = FFI()
    for header in HEADERS:
        ffi.cdef(declarations(header))
    return ffi, ffi.dlopen(str(path))
