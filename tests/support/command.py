"""`armodal` in this process: much sooner than a new one, and it says and returns the same."""

from __future__ import annotations

import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from typing import NamedTuple
from unittest.mock import patch

from armodal.tui.cli import main


class Said(NamedTuple):
    returncode: int
    stdout: str
    stderr: str


def armodal(*arguments: object) -> Said:
    """Run a command line to its end."""
    out, err = StringIO(), StringIO()
    code: object = 0
    with (
        patch.object(sys, "argv", ["armodal", *map(str, arguments)]),
        redirect_stdout(out),
        redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as end:
            code = end.code
    return Said(returncode=int(code or 0), stdout=out.getvalue(), stderr=err.getvalue())
