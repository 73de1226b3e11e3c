"""What this system can run: devices, real or simulated, need Linux or macOS."""

from __future__ import annotations

import sys

from armodal.protocols.errors import WrongSystemError

__all__ = ["check_runs_devices", "runs_devices"]


def runs_devices() -> bool:
    """Whether serial lines can be waited on and locked here."""
    return sys.platform != "win32"


def check_runs_devices(command: str) -> None:
    """Refuse a command that runs devices where that cannot be.

    Raises
    ------
    WrongSystemError
        On Windows.
    """
    if not runs_devices():
        raise WrongSystemError(
            f"wanted Linux or macOS for `armodal {command}`, which runs devices, real or "
            "simulated; this is Windows: bring the session file here to analyse it"
        )
