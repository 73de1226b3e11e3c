"""A page in headless Chromium, spoken to over a pipe (Chrome DevTools Protocol)."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from base64 import b64decode
from contextlib import contextmanager, suppress
from pathlib import Path

CHROMIUM = next(
    (p for n in ("chromium", "chromium-browser", "google-chrome") if (p := shutil.which(n))), None
)

# It listens on file descriptor 3 and answers on 4.
WITH_PIPE = """import os, sys
os.dup2(int(sys.argv[1]), 3)
os.dup2(int(sys.argv[2]), 4)
os.execv(sys.argv[3], sys.argv[3:])"""


class Page:
    """One open page: what it said wrong, what it asked for, and what it looks like."""

    def __init__(self, send, receive):
        self._send, self._receive = send, receive
        self._number = 0
        self._session = None
        self.problems, self.asked = [], []
        self._loaded = False
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        attached = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for part in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{part}.enable")

    def call(self, method, **params):
        """Ask for one thing, noting what happens until its answer."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        self._send(message)
        while True:
            answer = self._receive()
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self._note(answer)

    def _note(self, event):
        params = event.get("params", {})
        match event.get("method"):
            case "Page.loadEventFired":
                self._loaded = True
            case "Runtime.exceptionThrown":
                self.problems.append(params["exceptionDetails"].get("text", "exception"))
            case "Log.entryAdded" if params["entry"]["level"] == "error":
                self.problems.append(params["entry"]["text"])
            case "Network.requestWillBeSent":
                self.asked.append(params["request"]["url"])

    def open(self, path, width, height=900):
        """Load a file at a width and height in CSS pixels."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        self._loaded = False
        self.call("Page.navigate", url=Path(path).resolve().as_uri())
        while not self._loaded:
            self._note(self._receive())

    def run(self, script):
        """Value of an expression, waited for where it is a promise."""
        answer = self.call(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"]["exception"]["description"])
        return answer["result"].get("value")

    def close(self):
        """End the browser."""
        self._session = None
        with suppress(OSError, RuntimeError):  # it may be gone before it answers
            self.call("Browser.close")

    def pdf(self):
        """The page printed by its own style sheet."""
        return b64decode(self.call("Page.printToPDF", preferCSSPageSize=True)["data"])


def pdf_pages(pdf):
    """Number of pages of a PDF as Chromium writes it."""
    return len(re.findall(rb"/Type\s*/Page\b", pdf))


@contextmanager
def browser():
    """A browser's page, for as long as it is looked at."""
    to_child, from_us = os.pipe()
    to_us, from_child = os.pipe()
    with tempfile.TemporaryDirectory() as profile:
        command = [
            *(sys.executable, "-c", WITH_PIPE, str(to_child), str(from_child), CHROMIUM),
            *(
                "--headless",
                "--no-sandbox",
                "--enable-unsafe-swiftshader",
                "--remote-debugging-pipe",
            ),
            *("--no-first-run", "--disable-background-networking", f"--user-data-dir={profile}"),
        ]
        process = subprocess.Popen(
            command,
            pass_fds=(to_child, from_child),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_child)
        os.close(from_child)
        with os.fdopen(from_us, "wb", buffering=0) as out, os.fdopen(to_us, "rb") as back:
            messages = _messages(back)
            page = Page(
                lambda message: out.write(json.dumps(message).encode() + b"\0"),
                lambda: json.loads(next(messages)),
            )
            try:
                yield page
            finally:
                page.close()
                process.wait(30)


def _messages(stream):
    """Yield what comes, each up to its zero byte."""
    rest = b""
    while more := stream.read1(2**20):
        *whole, rest = (rest + more).split(b"\0")
        yield from whole
    raise RuntimeError("the browser closed the pipe")
