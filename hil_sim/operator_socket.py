"""The operator's ear: a Unix socket on which requests and answers are lines of JSON."""

from __future__ import annotations

import json
import os
import socket
import stat
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

from armodal.hil_sim.clock import LabClock
from armodal.hil_sim.operator import Action
from armodal.protocols.errors import PlantError
from armodal.protocols.os_words import os_words

__all__ = ["OperatorSocket", "check_free"]

MAX_LINE = 64 * 1024
MAX_WAITING = 64  # requests
MAX_BACKLOG = 256 * 1024
# The shortest limit among the systems we run on, terminating zero included.
MAX_SOCKET_PATH = 104


class OperatorSocket:
    """Serves one client at a time; requests are carried out one after the other.

    Parameters
    ----------
    path
        Where the socket is made; only its owner may connect.
    begin
        Turns a request into an action, `Operator.begin`.
    clock
        The laboratory's clock.

    Raises
    ------
    PlantError
        If the path is too long for a socket, or another laboratory listens there.
    """

    def __init__(self, path: Path, begin: Callable[[object], Action], *, clock: LabClock) -> None:
        if len(os.fsencode(path)) >= MAX_SOCKET_PATH:
            raise PlantError(
                f"wanted a socket path below {MAX_SOCKET_PATH} bytes, got {path}: "
                "give the laboratory a directory with a shorter path"
            )
        self.path = path
        self._begin = begin
        self._clock = clock
        check_free(path)
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            before = os.umask(0o177)  # from its first moment on it is its owner's alone
            try:
                self._listener.bind(str(path))
            finally:
                os.umask(before)
        except OSError as error:
            self._listener.close()
            raise PlantError(
                f"cannot listen at {path}: {os_words(error)}; give the laboratory another directory"
            ) from error
        self._listener.listen(4)
        self._listener.setblocking(False)
        self._client: socket.socket | None = None
        self._incoming = b""
        self._outgoing = b""
        self._waiting: deque[bytes] = deque()
        self._action: Action | None = None
        self._abandoned = False  # the client whose action it is has gone
        self._until_s = 0.0

    def readers(self) -> list[socket.socket]:
        """Sockets to select on."""
        return [self._listener] + ([self._client] if self._client else [])

    def step(self) -> None:
        """Do what is to be done now; never waits."""
        self._accept()
        self._receive()
        self._go_on()
        self._send()

    def close(self) -> None:
        """Hang up and remove the socket."""
        self._hang_up()
        self._listener.close()
        self.path.unlink(missing_ok=True)

    def _accept(self) -> None:
        try:
            client, _ = self._listener.accept()
        except BlockingIOError:
            return
        client.setblocking(False)
        if self._client is None:
            self._client = client
            return
        self._refuse(client)

    def _refuse(self, client: socket.socket) -> None:
        with client:
            try:
                client.send(_line({"error": "the operator serves another client: come back later"}))
            except OSError:
                return

    def _receive(self) -> None:
        if self._client is None:
            return
        try:
            data = self._client.recv(4096)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._hang_up()
            return
        *lines, self._incoming = (self._incoming + data).split(b"\n")
        self._waiting.extend(line for line in lines if line.strip())
        if len(self._incoming) > MAX_LINE or len(self._waiting) > MAX_WAITING:
            self._answer({"error": f"wanted lines below {MAX_LINE} bytes and few at a time"})
            self._send()
            self._hang_up()

    def _go_on(self) -> None:
        while True:
            if self._action is None:
                if not self._waiting:
                    return
                self._start(self._waiting.popleft())
            elif self._clock.now_s() < self._until_s:
                return
            else:
                self._resume(self._action)

    def _start(self, line: bytes) -> None:
        try:
            request = json.loads(line)
        except (ValueError, RecursionError) as error:
            self._answer({"error": f"wanted one line of JSON, got something else: {error}"})
            return
        try:
            self._action = self._begin(request)
        except PlantError as error:
            self._answer({"error": str(error)})
            return
        self._until_s = self._clock.now_s()
        self._abandoned = False

    def _resume(self, action: Action) -> None:
        try:
            self._until_s = next(action)
        except StopIteration as end:
            self._action = None
            self._answer_unless_gone(end.value)
        except PlantError as error:
            self._action = None
            self._answer_unless_gone({"error": str(error)})

    def _answer_unless_gone(self, answer: dict[str, Any]) -> None:
        if not self._abandoned:
            self._answer(answer)

    def _answer(self, answer: dict[str, Any]) -> None:
        if self._client is not None:
            self._outgoing += _line(answer)

    def _send(self) -> None:
        if self._client is None or not self._outgoing:
            return
        try:
            self._outgoing = self._outgoing[self._client.send(self._outgoing) :]
        except BlockingIOError:
            if len(self._outgoing) > MAX_BACKLOG:
                self._hang_up()
        except OSError:
            self._hang_up()

    def _hang_up(self) -> None:
        """Forget the client; what it had begun is finished, its answer goes nowhere."""
        if self._client is not None:
            self._client.close()
        self._client = None
        self._abandoned = True
        self._incoming = self._outgoing = b""
        self._waiting.clear()


def _line(answer: dict[str, Any]) -> bytes:
    return json.dumps(answer).encode() + b"\n"


def check_free(path: Path) -> None:
    """Remove the socket of a laboratory that was killed; raise PlantError where one listens."""
    try:
        if not stat.S_ISSOCK(path.lstat().st_mode):
            return
    except FileNotFoundError:
        return
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as caller:
        try:
            caller.connect(str(path))
        except ConnectionRefusedError:
            path.unlink(missing_ok=True)
            return
        except OSError:
            return
    raise PlantError(
        f"another laboratory listens at {path}: stop it, or give this one another directory"
    )
