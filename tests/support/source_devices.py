"""Each source of samples with a hammer's hits in it, as a session finds it.

The device of a source is a process where it is one in a laboratory: it can be killed.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
from support.wav_file import write_wav

HERE = Path(__file__).resolve().parent
RATE_HZ = 25_600
RANGE_V = 5.0
FULL_SCALES = (800.0, 80.0, 80.0, 80.0)  # N, then m/s^2
NAMES = ("hammer", "acc_x", "acc_y", "acc_z")


def played(every_s: float) -> np.ndarray:
    """Counts of one hit of 200 N in 2 ms with an answer that has died away in 80 ms."""
    t = np.arange(int(every_s * RATE_HZ)) / RATE_HZ - 0.05
    force = np.where((t >= 0) & (t < 2e-3), np.sin(np.pi * t / 2e-3), 0.0) * 200.0
    answer = np.where(t > 0, np.exp(-60.0 * t) * np.sin(2 * np.pi * 120.0 * t), 0.0) * 20.0
    physical = np.stack([force, answer, 0.3 * answer, -answer], axis=1)
    noise = np.random.default_rng(1).normal(0.0, 100.0, physical.shape)
    return np.rint(physical / FULL_SCALES * 2**23 + noise).astype(np.int32)


def channel_tables(inputs: tuple[object, ...], scale: str) -> str:
    """Tables of a front-end file; `scale` is the key, full_scale or sensitivity_mv."""
    text = ""
    for name, full_scale, place in zip(NAMES, FULL_SCALES, inputs, strict=True):
        quantity = "force" if name == "hammer" else "acceleration"
        shown = place if isinstance(place, int) else f'"{place}"'
        value = full_scale if scale == "full_scale" else 1e3 * RANGE_V / full_scale
        text += f'[[channels]]\nname = "{name}"\nquantity = "{quantity}"\n'
        text += f"input = {shown}\n{scale} = {value}\n"
    return text


Started = tuple[str, subprocess.Popen[str] | None]  # text of the front-end file, device's process


def _replay(folder: Path, every_s: float, seconds: float) -> Started:
    one = played(every_s)
    write_wav(folder / "hits.wav", np.tile(one, (int(seconds / every_s) + 5, 1)), RATE_HZ)
    head = 'format = "armodal-front-end-1"\ndevice = "replay"\nsource = "hits.wav"\n'
    return head + channel_tables((1, 2, 3, 4), "full_scale"), None


def _sound(folder: Path, every_s: float, seconds: float) -> Started:
    write_wav(folder / "hits.wav", played(every_s), RATE_HZ)
    os.environ["ARMODAL_TEST_SOUND"] = str(folder / "hits.wav")
    os.environ["PYTHONPATH"] = str(HERE / "played_card")  # of the process that is started
    head = 'format = "armodal-front-end-1"\ndevice = "sound"\n'
    return head + channel_tables((1, 2, 3, 4), "full_scale"), None


def _served(command: list[str]) -> tuple[subprocess.Popen[str], str]:
    server = subprocess.Popen(
        [sys.executable, *command],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    if sys.platform == "linux":
        with suppress(OSError):  # a device of its own does not wait for this computer's work
            os.sched_setscheduler(server.pid, os.SCHED_RR, os.sched_param(1))
    assert server.stdout is not None
    return server, server.stdout.readline().strip()


def _ni(folder: Path, every_s: float, seconds: float) -> Started:
    np.save(folder / "volts.npy", played(every_s) / 2**23 * RANGE_V)
    server, port = _served([str(HERE / "ni_server.py"), str(folder / "volts.npy")])
    head = 'format = "armodal-front-end-1"\ndevice = "ni"\nsource = "cDAQ1Mod1"\n'
    head += f'server = "127.0.0.1:{port}"\nrange_v = {RANGE_V}\n'
    return head + channel_tables(("ai0", "ai1", "ai2", "ai3"), "sensitivity_mv"), server


def _opendaq(folder: Path, every_s: float, seconds: float) -> Started:
    np.save(folder / "volts.npy", played(every_s) / 2**23 * RANGE_V)
    command = [str(HERE / "opendaq_server.py"), str(folder / "volts.npy"), str(RATE_HZ)]
    server, port = _served(command)
    head = 'format = "armodal-front-end-1"\ndevice = "opendaq"\n'
    head += f'source = "daq.ns://127.0.0.1:{port}"\nrange_v = {RANGE_V}\n'
    return head + channel_tables(("AI0", "AI1", "AI2", "AI3"), "sensitivity_mv"), server


# How a source is started: given a folder, how often a hit shall come and for how long at least, in
# s, each returns the text of a front-end file and the device's process.
SOURCES: dict[str, Callable[[Path, float, float], Started]] = {
    "replay": _replay,
    "sound": _sound,
    "ni": _ni,
    "opendaq": _opendaq,
}
