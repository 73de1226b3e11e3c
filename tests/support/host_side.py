"""The host's side of the lines, by nothing but os.read, os.write and the shared codecs."""

import json
import os
import select
import socket
import time

from armodal.protocols.board.codec import FrameDecoder, encode_frame
from armodal.protocols.board.records import FrameType, Header

DEADLINE_S = 60.0  # far beyond what a loaded machine takes; reaching it is a failure


class Line:
    def __init__(self, path, step=None):
        self.fd = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        self.step = step

    def close(self):
        os.close(self.fd)

    def write(self, data):
        assert os.write(self.fd, data) == len(data)

    def read(self):
        if self.step is not None:
            self.step()
        ready, _, _ = select.select([self.fd], [], [], 0.0 if self.step else 0.05)
        return os.read(self.fd, 65536) if ready else b""

    def read_until(self, enough):
        got, end = b"", time.monotonic() + DEADLINE_S
        while not enough(got):
            assert time.monotonic() < end, f"only {got!r}"
            got += self.read()
        return got


class BoardLine(Line):
    def __init__(self, path, step=None):
        super().__init__(path, step)
        self.decoder = FrameDecoder()
        self.frames = []
        self.session = 0
        self.sequence = 0
        self.tag = 0

    def pump(self):
        frames = self.decoder.feed(self.read())
        self.frames += frames
        return frames

    def send(self, kind, payload=b"", session=None):
        self.tag += 1
        session = self.session if session is None else session
        self.write(
            encode_frame(
                Header(type=kind, session=session, sequence=self.sequence, tag=self.tag), payload
            )
        )
        self.sequence += 1
        return self.tag

    def ask(self, kind, payload=b"", session=None):
        tag, seen = self.send(kind, payload, session), len(self.frames)
        self.until(lambda: any(f.header.tag == tag for f in self.frames[seen:]))
        reply = next(f for f in self.frames[seen:] if f.header.tag == tag)
        if kind is FrameType.HELLO:
            self.session = reply.header.session
        return reply

    def until(self, condition):
        end = time.monotonic() + DEADLINE_S
        while not condition():
            assert time.monotonic() < end, f"{len(self.frames)} frames came"
            self.pump()

    def of(self, kind):
        return [f for f in self.frames if f.header.type is kind]


class OperatorLine:
    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.socket.settimeout(DEADLINE_S)
        self.socket.connect(str(path))
        self.file = self.socket.makefile("rb")

    def ask(self, **request):
        return self.ask_raw(json.dumps(request).encode())

    def ask_raw(self, line):
        self.socket.sendall(line + b"\n")
        return json.loads(self.file.readline())

    def close(self):
        self.file.close()
        self.socket.close()
