"""Start and stop the simulated laboratory as a process of its own."""

from __future__ import annotations

import json
import re
import select
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Self

from armodal.hil_sim.rehearsal import Rehearsal, write_rehearsal
from armodal.hil_sim.temporary import new_lab_folder
from armodal.protocols.errors import ArmodalError, DeviceLostError, DeviceTimeoutError, PlantError

__all__ = ["Laboratory", "launch", "start_laboratory"]

READY_TIMEOUT_S = 60.0  # the size of what a drawn arm hides is searched for
REHEARSAL = "rehearsal.json"
STOP_TIMEOUT_S = 5.0
_FRAME = re.compile(r'File "(?P<file>[^"]+)", line (?P<line>\d+)')


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
    truth_sha256 : str
        Of the truth in the ledger.
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
        self._failure: str | None = None
        self._temporary = temporary
        self.board = str(ready["board"])
        self.can = str(ready["can"])
        self.operator = Path(str(ready["operator"]))
        self.ledger = Path(str(ready["ledger"]))
        self.time_scale = float(str(ready["time_scale"]))
        self.input_range_v = float(str(ready["input_range_v"]))
        self.truth_sha256 = str(ready["truth_sha256"])
        self.pid = process.pid

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        failure = self.failure() if isinstance(error, ArmodalError) else None
        self.close()
        if failure is not None:
            # Whatever was noticed of it outside is only what followed.
            raise DeviceLostError(failure) from error

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self._process.poll() is None

    def wait(self) -> None:
        """Wait until the laboratory ends.

        Raises
        ------
        DeviceLostError
            If it failed; the message says why.
        """
        self._process.wait()
        failure = self.failure()
        if failure is not None:
            raise DeviceLostError(failure)

    def failure(self) -> str | None:
        """Return why the laboratory has ended by itself; None while it runs, or was stopped."""
        if self._failure is None and self._process.poll() not in (None, 0):
            self._failure = _why(self._process)
        return self._failure

    def close(self) -> None:
        """Stop the laboratory; a second call does nothing.

        The ledger stays where the caller named a directory; a temporary directory is removed.
        """
        self.failure()  # while its last words can be read
        _end(self._process)
        if self._temporary is not None:
            shutil.rmtree(self._temporary, ignore_errors=True)


def start_laboratory(
    plant: str | Path | Rehearsal = "rv4frl",
    *,
    seed: int = 1,
    time_scale: float = 1.0,
    directory: Path | None = None,
    faults: Sequence[str] = (),
) -> Laboratory:
    """Start the laboratory and wait until it is ready.

    Parameters
    ----------
    plant
        A plant file, the name of a shipped one, or any arm, whose truth is then drawn and sealed.
    seed
        For everything random in it.
    time_scale
        Lab seconds a second.
    directory
        Private directory of socket and ledger, made if missing; None takes a temporary one, which
        goes with the laboratory.
    faults
        Names from `hil_sim.faults.Fault`, active from the beginning.

    Raises
    ------
    PlantError
        If the laboratory cannot start with this; the message is its own.
    DeviceTimeoutError, DeviceLostError
        If it does not become ready.
    """
    temporary = new_lab_folder() if directory is None else None
    home = directory or temporary or Path()
    command = [sys.executable, "-m", "armodal.hil_sim", "--seed", str(seed)]
    command += ["--time-scale", str(time_scale), "--directory", str(home), "--watch-stdin"]
    if isinstance(plant, Rehearsal):
        home.mkdir(mode=0o700, parents=True, exist_ok=True)
        write_rehearsal(plant, home / REHEARSAL)
        command += ["--rehearsal", str(home / REHEARSAL)]
    else:
        command += ["--plant", str(plant)]
    for fault in faults:
        command += ["--fault", fault]
    return launch(command, temporary=temporary)


def launch(command: Sequence[str], *, temporary: Path | None = None) -> Laboratory:
    """Start a laboratory by its command line; it must print the ready line of `hil_sim`."""
    process: subprocess.Popen[bytes] | None = None
    try:
        with _signals_after():
            # The command is composed here, of this interpreter and checked values.
            process = subprocess.Popen(  # noqa: S603
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
            )
        return Laboratory(process, _ready_line(process), temporary=temporary)
    except BaseException:
        if process is not None:
            _end(process)
        if temporary is not None:
            shutil.rmtree(temporary, ignore_errors=True)
        raise


@contextmanager
def _signals_after() -> Iterator[None]:
    """Put SIGINT and SIGTERM off: between a process and its name nobody could end it."""
    numbers = signal.SIGINT, signal.SIGTERM
    is_main = threading.current_thread() is threading.main_thread()
    handlers = {n: signal.getsignal(n) for n in numbers if is_main}
    # What is ignored stays so, in the new process too.
    handlers = {n: handler for n, handler in handlers.items() if callable(handler)}
    put_off: list[int] = []
    for number in handlers:
        signal.signal(number, lambda late, _: put_off.append(late))
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for caught in put_off:
            signal.raise_signal(caught)


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
        if process.wait() == 2:
            text = process.stderr.read().decode(errors="replace").strip()
            raise PlantError(text.removeprefix("hil_sim: "))
        raise DeviceLostError(_why(process))
    ready: dict[str, object] = json.loads(line)
    return ready


def _why(process: subprocess.Popen[bytes]) -> str:
    """Why a laboratory has ended by itself: its last words, and where it was."""
    told = b"" if process.stderr is None or process.stderr.closed else process.stderr.read()
    if process.returncode < 0:
        return (
            f"the simulated laboratory was ended from outside by signal {-process.returncode}; "
            "start it again"
        )
    lines = [line.strip() for line in told.decode(errors="replace").splitlines() if line.strip()]
    where = [found for line in lines if (found := _FRAME.match(line))]
    words = lines[-1] if lines else "it left no word"
    if where:
        words += f" ({Path(where[-1]['file']).name}, line {where[-1]['line']})"
    return (
        f"the simulated laboratory ended by itself with exit code {process.returncode}: {words}; "
        "this is a fault of the simulation, not of a device or of your files: report it with the "
        "arm file, the plan and the seed"
    )


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
