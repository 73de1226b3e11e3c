"""A decoder in a process of its own that may take so much memory and time, and no more."""

from __future__ import annotations

import os
import pickle
import resource
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from armodal.analyzer.corrected.posture_file import read_postures
from armodal.analyzer.own_arm.meshes import coal, read_mesh
from armodal.analyzer.report.gap_file import read_gap
from armodal.hil_sim.plant_file import load_plant_file
from armodal.protocols.arm.files import arm_from_texts, load_arm
from armodal.protocols.errors import ArmodalError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.manifest import load_manifest
from armodal.protocols.foreign.measured import Hints
from armodal.protocols.foreign.read_motion import read_motion_log
from armodal.protocols.front_end import load_front_end
from armodal.protocols.inertia_targets import load_inertia_targets
from armodal.protocols.mqtt_joints import load_mqtt_joints
from armodal.protocols.plan import load_plan
from armodal.protocols.robot.read import read_robot
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.sensor_memory import load_sensors
from armodal.protocols.sensors_file import load_equipment
from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.session.journal import load_journal
from armodal.protocols.session.journal_bytes import journal_file
from armodal.protocols.session.salvage import salvage

SMALL_FILE, SMALL_BYTES = 1_100_000, 200_000_000
LARGE_BYTES = 1_000_000_000  # of a file up to 100 MB
MOST_S = 10

_ARM = load_arm("rv4frl")
with suppress(ArmodalError):
    coal()  # libraries are loaded before anything is counted
for _name in ("mujoco", "mcap.reader", "rosbags.highlevel", "rosbags.typesys", "nptdms"):
    with suppress(ImportError):
        import_module(_name)


def _text(path: Path) -> str:
    return path.read_bytes().decode(errors="replace")


def _salvage(path: Path) -> None:
    with journal_file(path) as data:
        for session in salvage(data).sessions:
            for _ in session.parts():
                pass


DECODERS: dict[str, Callable[[Path], object]] = {
    "arm": load_arm,
    "content": lambda path: read_content(path, Hints()),
    "dbc": lambda path: arm_from_texts(
        _ARM.text, urdf_text=_ARM.urdf_text, database_text=_text(path)
    ),
    "journal": load_journal,
    "front end": load_front_end,
    "gap result": read_gap,
    "journal salvaged": _salvage,
    "manifest": load_manifest,
    "mesh": read_mesh,
    "motion": lambda path: read_motion_log(path, _ARM),
    "mqtt": load_mqtt_joints,
    "plan": lambda path: load_plan(path, _ARM),
    "plant": load_plant_file,
    "postures": lambda path: read_postures(path, 6),
    "robot": lambda path: read_robot(path, Remarks()),
    "sensors": load_equipment,
    "sensor memory": load_sensors,
    "session": read_session,
    "targets": lambda path: load_inertia_targets(path, _ARM),
    "glutton": lambda _path: bytearray(10**9),  # to see that too much is told
    "large": lambda _path: b"x" * (SMALL_BYTES + 10**7),
    "urdf": lambda path: arm_from_texts(_ARM.text, urdf_text=_text(path), database_text=None),
}


@dataclass(frozen=True)
class Taken:
    """What decoding a file took, and what came of it."""

    bytes: int  # at most, beyond what the process had before
    cpu_s: float
    said: str  # empty if it was read; otherwise the refusal, or what went wrong
    is_fault: bool


def wrong_with(decoder: str, path: Path) -> str:
    """Return how a decoder goes beyond its bounds with a file; empty if it does not."""
    stored = 512 * path.stat().st_blocks  # without holes
    most = SMALL_BYTES if stored <= SMALL_FILE else LARGE_BYTES
    taken = decode_bounded(decoder, path, most_bytes=most, most_s=MOST_S)
    if taken.is_fault:
        return f"{decoder}: {taken.said}"
    if taken.bytes > most or taken.cpu_s > MOST_S:
        return f"{decoder}: {taken.bytes // 10**6} MB, {taken.cpu_s:.1f} s, {taken.said}"
    return ""


def decode_bounded(decoder: str, path: Path, *, most_bytes: int, most_s: int) -> Taken:
    """Decode a file in a fork of this process, which has loaded all it needs.

    Address space and processor time are limited at twice what is allowed: what is beyond is told.
    """
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        try:
            taken = _decode(decoder, path, most_bytes, most_s)
            os.write(writing, pickle.dumps(taken))
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as file:
        data = file.read()
    _, status = os.waitpid(child, 0)
    if not data:
        return Taken(0, float(2 * most_s), f"ended by {os.waitstatus_to_exitcode(status)}", True)
    taken: Taken = pickle.loads(data)  # noqa: S301 - of our own fork
    return taken


def _decode(decoder: str, path: Path, most_bytes: int, most_s: int) -> Taken:
    signal.signal(signal.SIGXCPU, signal.SIG_DFL)
    before = _status("VmSize")
    resource.setrlimit(resource.RLIMIT_AS, (before + 2 * most_bytes,) * 2)
    used = int(time.process_time())
    resource.setrlimit(resource.RLIMIT_CPU, (used + 2 * most_s,) * 2)
    Path("/proc/self/clear_refs").write_text("5")  # the peak counts from here
    before, begun = _status("VmRSS"), time.process_time()
    said, is_fault = "", False
    try:
        DECODERS[decoder](path)
    except ArmodalError as error:
        said = str(error)
    except BaseException as error:  # noqa: BLE001 - any other error is the finding
        said, is_fault = f"{type(error).__name__}: {error}"[:300], True
    used = resource.getrusage(resource.RUSAGE_CHILDREN)  # programs of others are bounded apart
    cpu_s = time.process_time() - begun + used.ru_utime + used.ru_stime
    return Taken(_status("VmHWM") - before, cpu_s, said, is_fault)


def _status(what: str) -> int:
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(f"{what}:"):
            return 1024 * int(line.split()[1])
    raise LookupError(what)
