"""Start and stop the simulated laboratory as a process of its own."""

from __future__ import annotations

import json
import select
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self

from armodal.protocols.errors import DeviceLostError, DeviceTimeoutError, PlantError

__all__ = ["Laboratory", "launch", "start_laboratory"]

READY_TIMEOUT_S = 30.0
STOP_TIMEOUT_S = 5.0


class Laboratory:
    """A running laboratory; leaving the context stops it.

    Attributes
    ----------
    board, can : str
        Pseudo-terminals of the acquisition board and of the slcan adapter.
    operator : Path
        Unix socket of the operator.
    ledger : Path
        Ledger of what truly happens.
    time_scale : float
        Lab seconds a second.
    input_range_v : float
        Largest voltage of the board's inputs.
    pid : int
        Process that runs it.
    """

    def __init__(
        self,
        process: subprocess.Popen[bytes],
        ready: dict[str, object],
        *,
        temporary: Path | None = None,
    ) -> None:
        self._process = process
        self._temporary = temporary
        self.board = str(ready["board"])
        self.can = str(ready["can"])
        self.operator = Path(str(ready["operator"]))
        self.ledger = Path(str(ready["ledger"]))
        self.time_scale = float(str(ready["time_scale"]))
        self.input_range_v = float(str(ready["input_range_v"]))
        self.pid = process.pid

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self._process.poll() is None

    def wait(self) -> int:
        """Wait until the laboratory ends by itself; return its exit code."""
        return self._process.wait()

    def close(self) -> None:
        """Stop the laboratory; a second call does nothing.

        The ledger stays where the caller named a directory; a temporary directory is removed.
        """
        _end(self._process)
        if self._temporary is not None:
            shutil.rmtree(self._temporary, ignore_errors=True)


def start_laboratory(
    plant: str | Path = "rv4frl",
    *,
    seed: int = 1,
    time_scale: float = 1.0,
    directory: Path | None = None,
    faults: Sequence[str] = (),
    receive_bytes: int | None = None,
) -> Laboratory:
    """Start the laboratory and wait until it is ready.

    Parameters
    ----------
    plant
        A plant file, or the name of a shipped one.
    seed
        For everything random in it.
    time_scale
        Lab seconds a second.
    directory
        Private directory of socket and ledger, made if missing; None takes a temporary one, which
        goes with the laboratory.
    faults
        Names from `hil_sim.faults.Fault`, active from the beginning.
    receive_bytes
        Size of the board's buffer for commands; None takes the smallest that the protocol allows.

    Raises
    ------
    PlantError
        If the laboratory cannot start with this; the message is its own.
    DeviceTimeoutError, DeviceLostError
        If it does not become ready.
    """
    temporary = Path(tempfile.mkdtemp(prefix="armodal-")) if directory is None else None
    home = directory if directory is not None else temporary
    command = [sys.executable, "-m", "armodal.hil_sim", "--plant", str(plant), "--seed", str(seed)]
    command += ["--time-scale", str(time_scale), "--directory", str(home), "--watch-stdin"]
    for fault in faults:
        command += ["--fault", fault]
    if receive_bytes is not None:
        command += ["--receive-bytes", str(receive_bytes)]
    return launch(command, temporary=temporary)


def launch(command: Sequence[str], *, temporary: Path | None = None) -> Laboratory:
    """Start a laboratory by its command line; it must print the ready line of `hil_sim`."""
    # The command is composed here, of this interpreter and checked values.
    process = subprocess.Popen(  # noqa: S603
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    try:
        return Laboratory(process, _ready_line(process), temporary=temporary)
    except BaseException:
        _end(process)
        if temporary is not None:
            shutil.rmtree(temporary, ignore_errors=True)
        raise


def _ready_line(process: subprocess.Popen[bytes]) -> dict[str, object]:
    if process.stdout is None or process.stderr is None:
        raise DeviceLostError("the laboratory's output is not connected")
    readable, _, _ = select.select([process.stdout], [], [], READY_TIMEOUT_S)
    if not readable:
        raise DeviceTimeoutError(
            f"the laboratory is not ready after {READY_TIMEOUT_S:g} s: "
            "run python -m armodal.hil_sim to see why"
        )
    line = process.stdout.readline()
    if not line:
        text = process.stderr.read().decode(errors="replace").strip()
        if process.wait() == 2:
            raise PlantError(text.removeprefix("hil_sim: "))
        raise DeviceLostError(f"the laboratory ended before it was ready: {text}")
    ready: dict[str, object] = json.loads(line)
    return ready


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ask a process to end, and make it end if it does not."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(STOP_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    for stream in (process.stdin, process.stdout, process.stderr):
        if stream is not None:
            with suppress(BrokenPipeError):
                stream.close()
