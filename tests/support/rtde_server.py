"""A Universal Robots controller by its RTDE port: answers as the guide says, notes what comes."""

from __future__ import annotations

import socket
import struct
import threading
from collections import Counter
from contextlib import suppress

TYPES = {
    "timestamp": ("DOUBLE", "d"),
    "actual_q": ("VECTOR6D", "6d"),
    "robot_mode": ("INT32", "i"),
    "robot_status_bits": ("UINT32", "I"),
}
RUNNING = 7


class RtdeServer:
    """One client at a time. What it tells can be changed while it runs.

    `received` counts the types of the packages that came; `lacks` are outputs it does not know.
    """

    def __init__(self, joints_rad, *, lacks=(), accepts=True, scale=1.0, mute=False) -> None:
        self.joints_rad = tuple(joints_rad)
        self.robot_mode, self.status_bits = RUNNING, 0b1
        self.lacks, self.accepts, self.scale, self.mute = lacks, accepts, scale, mute
        self.silent = False
        self.received: Counter[str] = Counter()
        self.timestamp_s = 100.0
        self.step_s = 1.0  # of its clock, in packages
        self._stop = threading.Event()
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

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
        data, names, rate_hz, runs = b"", (), 125.0, False
        while not self._stop.is_set():
            line.settimeout(1.0 / rate_hz / self.scale if runs else 0.05)
            with suppress(TimeoutError):
                more = line.recv(4096)
                if not more:
                    return
                data += more
            while len(data) >= 3 and len(data) >= (size := struct.unpack_from(">H", data)[0]):
                kind, payload, data = chr(data[2]), data[3:size], data[size:]
                self.received[kind] += 1
                if kind == "O":
                    rate_hz = struct.unpack_from(">d", payload)[0]
                    names = tuple(payload[8:].decode().split(","))
                runs = runs or (kind == "S" and self.accepts)
                if not self.mute:
                    line.sendall(self._answer(kind, names))
            if runs and not self.silent:
                self.timestamp_s += self.step_s / rate_hz
                line.sendall(self._sample(names))

    def _answer(self, kind: str, names: tuple[str, ...]) -> bytes:
        if kind == "O":
            types = ["NOT_FOUND" if n in self.lacks else TYPES[n][0] for n in names]
            return package(kind, b"\x01" + ",".join(types).encode())
        if kind == "v":
            return package(kind, struct.pack(">IIII", 5, 11, 0, 0))
        return package(kind, bytes([self.accepts]))

    def _sample(self, names: tuple[str, ...]) -> bytes:
        values = {
            "timestamp": (self.timestamp_s,),
            "actual_q": self.joints_rad,
            "robot_mode": (self.robot_mode,),
            "robot_status_bits": (self.status_bits,),
        }
        return package(
            "U",
            b"\x01" + b"".join(struct.pack(f">{TYPES[n][1]}", *values[n]) for n in names),
        )


def package(kind: str, payload: bytes = b"") -> bytes:
    return struct.pack(">HB", 3 + len(payload), ord(kind)) + payload
