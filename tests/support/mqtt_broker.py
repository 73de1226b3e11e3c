"""A small MQTT 3.1.1 broker with one topic of its own: OASIS standard, sections 2 and 3.

It answers a client, tells messages so often, and counts the types of packets that come.
"""

from __future__ import annotations

import json
import socket
import struct
import threading
import time
from collections import Counter
from contextlib import suppress

CONNECT, CONNACK, PUBLISH, SUBSCRIBE, SUBACK = 1, 2, 3, 8, 9
PINGREQ, PINGRESP, DISCONNECT = 12, 13, 14
KEPT = 1  # the flag RETAIN
REFUSED, NOT_GRANTED = 5, 0x80


class MqttBroker:
    """One client at a time. What it tells can be changed while it runs.

    `tell` makes the message of a time in seconds; `kept` is a message that it has kept, told at
    once. `received` counts packets by their type, `will` whether a client left a last will.
    """

    def __init__(self, tell, *, topic="cell/state", rate_hz=50.0, scale=1.0, kept=None) -> None:
        self.tell, self.topic, self.rate_hz, self.scale, self.kept = (
            tell,
            topic,
            rate_hz,
            scale,
            kept,
        )
        self.silent, self.refuses, self.grants, self.mute = False, False, True, False
        self.received: Counter[int] = Counter()
        self.will, self.told = False, 0
        self.t_s = 100.0
        self._stop = threading.Event()
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def until(self, kind: int, timeout_s: float = 10.0) -> None:
        """Wait until such a packet has come."""
        end = time.monotonic() + timeout_s
        while not self.received[kind]:
            assert time.monotonic() < end, f"packets that came: {dict(self.received)}"
            time.sleep(0.01)

    def close(self) -> None:
        self._stop.set()
        self._listener.close()
        self._thread.join(5.0)

    def _run(self) -> None:
        self._listener.settimeout(0.05)
        while not self._stop.is_set():
            with suppress(TimeoutError, OSError):
                line, _ = self._listener.accept()
                with line:
                    line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                    self._serve(line)

    def _serve(self, line: socket.socket) -> None:
        data, listens = b"", False
        while not self._stop.is_set():
            line.settimeout(1.0 / self.rate_hz / self.scale)
            with suppress(TimeoutError):
                more = line.recv(4096)
                if not more:
                    return
                data += more
            while (cut := whole(data)) is not None:
                kind, body, data = cut
                self.received[kind] += 1
                if kind == CONNECT:
                    self.will = bool(body[7] & 4)
                if not self.mute:
                    line.sendall(self._answer(kind, body))
                if kind == SUBSCRIBE and self.grants:
                    listens = True
                    if self.kept is not None:
                        line.sendall(self._message(self.kept, KEPT))
                if kind == DISCONNECT:
                    return
            if listens and not self.silent:
                self.t_s += 1.0 / self.rate_hz
                with suppress(OSError):  # one that goes may have said so before
                    line.sendall(self._message(self.tell(self.t_s)))
                    self.told += 1

    def _answer(self, kind: int, body: bytes) -> bytes:
        if kind == CONNECT:
            return packet(CONNACK, bytes([0, REFUSED if self.refuses else 0]))
        if kind == SUBSCRIBE:
            return packet(SUBACK, body[:2] + bytes([0 if self.grants else NOT_GRANTED]))
        return packet(PINGRESP, b"") if kind == PINGREQ else b""

    def _message(self, told: object, flags: int = 0) -> bytes:
        text = told if isinstance(told, bytes) else json.dumps(told).encode()
        name = self.topic.encode()
        return packet(PUBLISH, struct.pack(">H", len(name)) + name + text, flags)


def packet(kind: int, body: bytes, flags: int = 0) -> bytes:
    """A fixed header, the length in sevens of bits, and what follows."""
    size, length = len(body), b""
    while True:
        size, low = divmod(size, 128)
        length += bytes([low | 128 * (size > 0)])
        if not size:
            return bytes([kind << 4 | flags]) + length + body


def whole(data: bytes) -> tuple[int, bytes, bytes] | None:
    """Type and body of the first packet, and what is behind it; None where it is not whole."""
    size = 0
    for i, byte in enumerate(data[1:5]):
        size |= (byte & 127) << 7 * i
        if byte < 128:
            end = 2 + i + size
            return (data[0] >> 4, data[2 + i : end], data[end:]) if len(data) >= end else None
    return None
