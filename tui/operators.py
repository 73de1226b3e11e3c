"""Run an acquisition process and act on its prompts: a person at the keyboard, or a script."""

from __future__ import annotations

import json
import math
import select
import socket
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import numpy as np

from armodal.daq.commands import Command, Ready, StatedPosture, Stop
from armodal.daq.events import Event, Failed, Finished, HitJudged, Noted, Prompted
from armodal.daq.geometry import hit_direction
from armodal.daq.operator_joints import posture_refusal
from armodal.daq.process import start_process
from armodal.daq.session_machine import Prompt, PromptKind
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmodalError, DeviceLostError, DeviceTimeoutError
from armodal.protocols.os_words import os_words
from armodal.protocols.plan_records import Plan, PlannedPosture

__all__ = [
    "AcquisitionFailedError",
    "Operator",
    "PersonAtTerminal",
    "Request",
    "ScriptedOperator",
    "acquire",
    "describe",
    "request_for",
]

END_TIMEOUT_S = 10.0
Show = Callable[[Event], None]
Request = dict[str, object]


class AcquisitionFailedError(ArmodalError, RuntimeError):
    """The acquisition ended with a message; what it had accepted is in the journal."""


class Operator(Protocol):
    """Whoever brings the arm to a posture, mounts the sensor and hits.

    `patience_s` is how long, in wall seconds, a hit may stay without an answer before it is tried
    again: a hit below the trigger level leaves no trace. None waits for ever.
    """

    patience_s: float | None

    def act(self, prompt: Prompt) -> Command | None:
        """Do what a prompt asks; return a command for the acquisition process, if any."""


class PersonAtTerminal:
    """A person: reads the prompt, presses Enter when the sensor is mounted.

    Parameters
    ----------
    ask
        Shows a text and returns the line typed.
    told_rad
        To how much he reads joint angles, where no device does.
    """

    patience_s: float | None = None

    def __init__(self, ask: Callable[[str], str], *, told_rad: float | None = None) -> None:
        self._ask = ask
        self._told_rad = told_rad

    def act(self, prompt: Prompt) -> Command | None:
        """Wait for Enter where something has to be mounted; the rest is seen by the devices."""
        if prompt.kind is PromptKind.POSTURE and self._told_rad is not None:
            return self._posture(prompt.posture, self._told_rad)
        if prompt.kind is not PromptKind.POINT:
            return None
        answer = self._ask(
            f"Mount the sensor at point {prompt.sensor_point}, hammer at {prompt.hit_point}; "
            "Enter when ready, q to stop: "
        )
        return Stop() if answer.strip().lower() == "q" else Ready()

    def _posture(self, posture: PlannedPosture | None, told_rad: float) -> Command | None:
        """Have the angles confirmed or typed, until they are those of the posture."""
        if posture is None:
            return None
        wanted = " ".join(f"{x + 0.0:g}" for x in np.rad2deg(posture.joints_rad).round(3))
        first = (
            f"Bring the arm to posture {posture.name}: {wanted} deg, held by its brakes or drives. "
            f"Enter if you read these to {math.degrees(told_rad):g} deg, or type what you read; "
            "q to stop: "
        )
        again = ""
        while (answer := self._ask(again + first).strip().lower()) != "q":
            word = _told(answer)
            refused = (
                f"wanted angles in degrees, got {answer!r}"
                if word is None
                else posture_refusal(word, posture, told_rad)
            )
            if word is not None and not refused:
                return word
            again = f"{refused}.\n"
        return Stop()


def _told(answer: str) -> StatedPosture | None:
    """Return what was typed, in degrees, as angles; None where it is no numbers."""
    if not answer:
        return StatedPosture()
    try:
        degrees = [float(part) for part in answer.replace(",", " ").split()]
    except ValueError:
        return None
    return StatedPosture(joints_rad=tuple(math.radians(x) for x in degrees))


def request_for(arm: Arm, prompt: Prompt) -> tuple[Request, str] | None:
    """Return what the simulated operator has to do for a prompt, and in words; None when done."""
    posture = prompt.posture
    if posture is None:
        return None
    if prompt.kind is PromptKind.POSTURE:
        degrees = [float(x) for x in np.rad2deg(posture.joints_rad)]
        return (
            {"do": "posture", "name": posture.name, "joints_deg": degrees},
            f"moves the arm to {posture.name}",
        )
    if prompt.kind is PromptKind.POINT:
        return (
            {"do": "mount", "point": prompt.sensor_point},
            f"mounts the sensor at {prompt.sensor_point}",
        )
    direction = [float(x) for x in hit_direction(arm, posture, prompt.hit_point)]
    request: Request = {"do": "hit", "point": prompt.hit_point, "direction": direction}
    peak_n = posture.peak_wanted_n(prompt.accepted)
    if peak_n is not None:
        request["peak_n"] = peak_n
    return request, f"hits point {prompt.hit_point}"


class ScriptedOperator:
    """The simulated laboratory's operator, asked over its private socket."""

    def __init__(
        self,
        path: Path,
        arm: Arm,
        plan: Plan,
        *,
        time_scale: float,
        timeout_s: float = 120.0,
        tells_posture: bool = False,
    ) -> None:
        self._arm = arm
        self._tells_posture = tells_posture
        block_s = plan.sampling.samples / float(plan.sampling.rate_hz)
        self.patience_s: float | None = 1.0 + 2.0 * block_s / time_scale
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.settimeout(timeout_s)
        try:
            self._socket.connect(str(path))
        except OSError as error:
            self._socket.close()
            raise DeviceLostError(
                f"no operator listens at {path} ({os_words(error)}); start one with armodal sim"
            ) from error
        self._lines = self._socket.makefile("r", encoding="utf-8")

    def act(self, prompt: Prompt) -> Command | None:
        """Have the scripted operator do it, and wait until it is done."""
        wanted = request_for(self._arm, prompt)
        if wanted is None:
            return None
        self.ask(wanted[0])
        if prompt.kind is PromptKind.POSTURE and self._tells_posture:
            return StatedPosture()
        return Ready() if prompt.kind is PromptKind.POINT else None

    @property
    def listens(self) -> bool:
        """Whether its laboratory is still there."""
        readable, _, _ = select.select([self._socket], [], [], 0.0)
        # Between requests nothing comes but the end.
        return not readable

    def close(self) -> None:
        """Hang up."""
        self._lines.close()
        self._socket.close()

    def ask(self, request: Request) -> None:
        """Send a request and wait until it is done.

        Raises
        ------
        DeviceLostError, DeviceTimeoutError
            If the operator refuses, is gone, or does not finish in time.
        """
        try:
            self._socket.sendall(json.dumps(request).encode() + b"\n")
            line = self._lines.readline()
        except TimeoutError as error:
            raise DeviceTimeoutError(
                f"the scripted operator did not finish '{request['do']}' in time"
            ) from error
        except OSError as error:
            raise DeviceLostError(f"the scripted operator is gone: {error}") from error
        if not line:
            raise DeviceLostError("the scripted operator hung up; is armodal sim still running?")
        answer = json.loads(line)
        if "error" in answer:
            raise DeviceLostError(f"the scripted operator refused: {answer['error']}")


def acquire(settings: AcquisitionSettings, operator: Operator, show: Show) -> Finished:
    """Run a session to its end in a process of its own.

    Raises
    ------
    AcquisitionFailedError
        If the session could not go on; the message is the acquisition's own.
    """
    running = start_process("acquire", settings)
    ours = running.channel
    try:
        pending: Prompt | None = None
        asked_s = 0.0
        while True:
            if pending is not None and operator.patience_s is not None:
                if time.monotonic() - asked_s > operator.patience_s:
                    operator.act(pending)
                    asked_s = time.monotonic()
                if not ours.poll(operator.patience_s):
                    continue
            try:
                event: Event = ours.recv()
            except EOFError as error:
                said = running.last_word()
                raise AcquisitionFailedError(
                    f"the acquisition process ended without a word{f' ({said})' if said else ''}; "
                    f"accepted hits are in {settings.journal}: armodal recover brings them back"
                ) from error
            show(event)
            if isinstance(event, Failed):
                raise AcquisitionFailedError(event.message)
            if isinstance(event, Finished):
                return event
            if isinstance(event, Prompted):
                command = operator.act(event.prompt)
                if command is not None:
                    ours.send(command)
                is_hit = event.prompt.kind is PromptKind.HIT
                pending, asked_s = (event.prompt if is_hit else None), time.monotonic()
    finally:
        ours.close()
        running.stderr.close()
        try:
            running.process.wait(END_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            running.process.terminate()
            running.process.wait()


def describe(event: Event) -> str | None:
    """Return one line about an event worth a line, else None."""
    if isinstance(event, HitJudged):
        hit = event.hit
        word = "accepted" if hit.verdict.accepted else "rejected: " + ", ".join(hit.verdict.reasons)
        return (
            f"hit {hit.number}: {hit.posture}, point {hit.sensor_point}, "
            f"{hit.verdict.peak_n:.0f} N, {word}"
        )
    if isinstance(event, Prompted) and event.prompt.kind is PromptKind.POSTURE:
        posture = event.prompt.posture
        return None if posture is None else f"bring the arm to posture '{posture.name}'"
    if isinstance(event, Noted):
        return f"note: {event.text}"
    return None
