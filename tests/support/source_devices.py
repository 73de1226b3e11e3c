"""Each source of samples with a hammer's hits in it, as a session finds it.

The device of a source is a process where it is one in a laboratory: it can be killed.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from support.wav_file import write_wav

HERE = Path(__file__).resolve().parent
RANGE_V = 5.0
FULL_SCALES = (800.0, 80.0, 80.0, 80.0)  # N, then m/s^2
NAMES = ("hammer", "acc_x", "acc_y", "acc_z")

OPENDAQ_SERVER = """
import opendaq, sys, time
instance = opendaq.Instance()
device = instance.add_device("daqref://device0")
for channel in device.channels_recursive:
    for name, value in (("Waveform", 0), ("Frequency", float(sys.argv[2])), ("Amplitude", 4.0)):
        channel.set_property_value(name, value)
device.set_property_value("GlobalSampleRate", 25000.0)
config = opendaq.PropertyObject()
port = opendaq.Integer(int(sys.argv[1]))
config.add_property(
    opendaq.IntProperty(opendaq.String("NativeStreamingPort"), port, opendaq.Boolean(True))
)
server = instance.add_server("OpenDAQNativeStreaming", config)
print("ready", flush=True)
time.sleep(3600)
"""


def played(rate_hz: int, every_s: float) -> np.ndarray:
    """Counts of one hit of 200 N in 2 ms with an answer that has died away in 80 ms."""
    t = np.arange(int(every_s * rate_hz)) / rate_hz - 0.05
    force = np.where((t >= 0) & (t < 2e-3), np.sin(np.pi * t / 2e-3), 0.0) * 200.0
    answer = np.where(t > 0, np.exp(-60.0 * t) * np.sin(2 * np.pi * 120.0 * t), 0.0) * 20.0
    physical = np.stack([force, answer, 0.3 * answer, -answer], axis=1)
    noise = np.random.default_rng(1).normal(0.0, 100.0, physical.shape)
    return np.rint(physical / FULL_SCALES * 2**23 + noise).astype(np.int32)


def channel_tables(inputs: tuple[object, ...], scale: str) -> str:
    """Tables of a front-end file; `scale` is the key, full_scale or sensitivity_mv."""
    text = ""
    for name, full_scale, place in zip(NAMES, FULL_SCALES, inputs, strict=False):
        quantity = "force" if name == "hammer" else "acceleration"
        shown = place if isinstance(place, int) else f'"{place}"'
        value = full_scale if scale == "full_scale" else 1e3 * RANGE_V / full_scale
        text += f'[[channels]]\nname = "{name}"\nquantity = "{quantity}"\n'
        text += f"input = {shown}\n{scale} = {value}\n"
    return text


Started = tuple[str, subprocess.Popen[str] | None]  # text of the front-end file, device's process


def _replay(folder: Path, every_s: float, seconds: float) -> Started:
    one = played(25_600, every_s)
    write_wav(folder / "hits.wav", np.tile(one, (int(seconds / every_s) + 5, 1)), 25_600)
    head = 'format = "armodal-front-end-1"\ndevice = "replay"\nsource = "hits.wav"\n'
    return head + channel_tables((1, 2, 3, 4), "full_scale"), None


def _sound(folder: Path, every_s: float, seconds: float) -> Started:
    write_wav(folder / "hits.wav", played(25_600, every_s), 25_600)
    os.environ["ARMODAL_TEST_SOUND"] = str(folder / "hits.wav")
    os.environ["PYTHONPATH"] = str(HERE / "played_card")  # of the process that is started
    head = 'format = "armodal-front-end-1"\ndevice = "sound"\n'
    return head + channel_tables((1, 2, 3, 4), "full_scale"), None


def _served(command: list[str]) -> tuple[subprocess.Popen[str], str]:
    server = subprocess.Popen(
        [sys.executable, *command], stdout=subprocess.PIPE, text=True, start_new_session=True
    )
    assert server.stdout is not None
    return server, server.stdout.readline().strip()


def _ni(folder: Path, every_s: float, seconds: float) -> Started:
    np.save(folder / "volts.npy", played(25_600, every_s) / 2**23 * RANGE_V)
    server, port = _served([str(HERE / "ni_server.py"), str(folder / "volts.npy")])
    head = 'format = "armodal-front-end-1"\ndevice = "ni"\nsource = "cDAQ1Mod1"\n'
    head += f'server = "127.0.0.1:{port}"\nrange_v = {RANGE_V}\n'
    return head + channel_tables(("ai0", "ai1", "ai2", "ai3"), "sensitivity_mv"), server


def _opendaq(folder: Path, every_s: float, seconds: float) -> Started:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server, _ = _served(["-c", OPENDAQ_SERVER, str(port), str(1.0 / every_s)])
    head = 'format = "armodal-front-end-1"\ndevice = "opendaq"\n'
    head += f'source = "daq.ns://127.0.0.1:{port}"\n'
    return head + f"range_v = {RANGE_V}\n" + channel_tables(
        ("AI0", "AI1"), "sensitivity_mv"
    ), server


@dataclass(frozen=True)
class Source:
    """How a source is started, and the rate it makes in Hz.

    `start` is given a folder, how often a hit shall come and for how long at least, in s; it
    returns the text of a front-end file and the device's process.
    """

    start: Callable[[Path, float, float], Started]
    rate_hz: int = 25_600


SOURCES = {
    "replay": Source(_replay),
    "sound": Source(_sound),
    "ni": Source(_ni),
    "opendaq": Source(_opendaq, rate_hz=25_000),
}
