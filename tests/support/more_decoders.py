"""Decoders of what came later: robots, meshes, logs of motion, packets, data sheets, small files.

As `decoders.py`; where a package of an extra is not installed, its formats are left out.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib import resources
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from support.damaged_journals import run_of
from support.fuzz_files import FileDecoder, mutate_hdf5, mutate_journal
from support.gap_results import made_result
from support.motion_bags import WRITERS
from support.mutate import mutated, mutated_text
from support.robot_files import box_stl, six_joints
from support.rtde_server import package
from support.teds_bits import iepe
from support.wav_file import FRONT_END

from armodal.analyzer.corrected.posture_file import read_postures
from armodal.analyzer.own_arm.meshes import read_mesh
from armodal.analyzer.own_arm.meshes import tried as load_mesh
from armodal.analyzer.report.gap_file import gap_from_json, gap_to_json
from armodal.daq.holder import read_holder, this_process
from armodal.hil_sim.plant_file import load_plant_file
from armodal.hil_sim.rehearsal import Rehearsal, read_rehearsal, write_rehearsal
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmodalError
from armodal.protocols.foreign.content import read_content
from armodal.protocols.foreign.measured import Hints
from armodal.protocols.foreign.motion_messages import streams_of
from armodal.protocols.foreign.read_motion import read_motion_log
from armodal.protocols.front_end import front_end_from_text
from armodal.protocols.mqtt_joints import mqtt_joints_from_text
from armodal.protocols.robot.mjcf import tried
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.robot.urdf_tree import read_tree
from armodal.protocols.robot.xacro_text import expanded
from armodal.protocols.rtde import (
    RtdeKind,
    RtdeParser,
    decode_accepted,
    decode_outputs,
    decode_sample,
    decode_version,
)
from armodal.protocols.sensor_memory import load_sensors
from armodal.protocols.sensors_file import load_equipment
from armodal.protocols.session.journal import MAGIC, decode_journal
from armodal.protocols.session.journal_bytes import InMemory
from armodal.protocols.session.salvage import salvage
from armodal.protocols.teds import decode_teds

Made = tuple[str, tuple[bytes, ...], Callable[[bytes], object], str]

MQTT = b"""
format = "armodal-mqtt-1"
broker = "192.168.1.20:1883"
topic = "cell/robot/state"
joints = "robot.axes"
unit = "deg"
rate_hz = 50.0
time = "stamp"
time_unit = "ms"
held = "robot.mode"
held_values = ["AUTO", 7]
"""
MQTT_MESSAGE = b'{"stamp": 12500, "robot": {"axes": [10, 20.5, -30, 1e3, 0.1, 2], "mode": "AUTO"}}'
SENSORS = b"""
format = "armodal-sensors-1"
[[hammers]]
name = "ours"
head_kg = 0.2
range_n = 1000.0
[[accelerometers]]
name = "triax"
mass_kg = 0.005
range_m_s2 = 490.0
noise_m_s2_per_sqrt_hz = 0.001
"""
MEMORY = json.dumps(
    {"format": "armodal-sensors-1", "sensors": {
        "force 17 hammer": {"sensitivity_mv": 2.2, "calibration_date": "", "used": "2026-01-02"}}}
).encode()  # fmt: skip
XACRO = b"""<?xml version="1.0"?>
<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="a" value="0.3"/><xacro:arg name="b" default="2"/>
<xacro:macro name="m" params="n *o"><link name="${n}"><visual><xacro:insert_block name="o"/>
<geometry><box size="${a} ${a*2} $(arg b)"/></geometry></visual></link></xacro:macro>
<xacro:m n="x"><origin xyz="0 0 ${a/2}"/></xacro:m>
<xacro:if value="${a > 0.1}"><link name="y"/></xacro:if>
<joint name="j" type="revolute"><parent link="x"/><child link="y"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>
"""
MJCF = b"""<mujoco model="m"><compiler angle="degree"/><default><joint damping="1"/></default>
<worldbody><body name="a"><inertial pos="0 0 .1" mass="2" diaginertia=".1 .1 .1"/>
<joint name="j1" axis="0 0 1" range="-90 90" limited="true"/><geom type="box" size=".1 .1 .1"/>
<body name="b" pos="0 0 .3"><joint name="j2" type="hinge" axis="0 1 0"/>
<geom type="capsule" size=".05 .2"/></body></body></worldbody></mujoco>
"""
OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
POSTURES = b"j1,j2,j3,j4,j5,j6\n" + b"1,2,3,4,5,6 # deg\n-10.5,0,3e1,4,5,6\n" * 5


def more_decoders(folder: Path, journal: bytes, small: dict[str, bytes]) -> Iterator[Made]:
    """Yield names, seeds, decoders, and how they are mutated: plain, text, hdf5 or journal."""
    arm = load_arm("rv4frl")
    hints = Hints()

    def content(path: Path) -> object:
        return read_content(path, hints)

    if find_spec("nptdms"):
        yield "tdms", (small["a.tdms"],), FileDecoder(folder, "f.tdms", content), "plain"
    yield "mat 7.3", (small["v73.mat"],), FileDecoder(folder, "f73.mat", content), "hdf5"
    yield "robot", (six_joints().urdf().encode(),), _tree, "text"
    if find_spec("xacrodoc"):
        yield "xacro", (XACRO,), FileDecoder(folder, "f.xacro", _expand), "text"
    if find_spec("mujoco"):
        yield "mjcf", (MJCF,), FileDecoder(folder, "f.xml", lambda p: tried(str(p))), "text"
    if find_spec("coal"):
        stl = box_stl(folder / "box.stl", (0.1, 0.2, 0.3)).read_bytes()
        yield "stl", (stl,), FileDecoder(folder, "f.stl", read_mesh), "plain"
        yield "obj", (OBJ,), FileDecoder(folder, "f.obj", lambda p: load_mesh(str(p))), "text"
    yield from _motion(folder, arm)
    yield "salvage", (journal, _two_in_one(journal)), _salvage, "journal"
    teds = tuple(iepe(0.01, is_force=force) for force in (True, False))
    yield "teds", teds, decode_teds, "plain"
    yield "rtde packets", (_rtde(),), _take_rtde, "plain"
    wanted = mqtt_joints_from_text(MQTT.decode(), origin="MQTT file")
    yield "mqtt message", (MQTT_MESSAGE,), lambda data: wanted.sample(data, 6), "text"
    yield (
        "mqtt file",
        (MQTT,),
        lambda data: mqtt_joints_from_text(_words(data), origin="MQTT file"),
        "text",
    )
    front_end = FRONT_END.format(file="hits.wav").encode()
    yield (
        "front end",
        (front_end,),
        lambda data: front_end_from_text(_words(data), name="f", origin="front-end file"),
        "text",
    )
    yield "sensors", (SENSORS,), FileDecoder(folder, "s.toml", load_equipment), "text"
    yield "sensor memory", (MEMORY,), FileDecoder(folder, "s.json", load_sensors), "text"
    gap = gap_to_json(made_result("named", ["payload"], standing=["bearing"])).encode()
    yield "gap result", (gap,), lambda data: gap_from_json(_words(data)), "text"
    yield (
        "postures",
        (POSTURES,),
        FileDecoder(folder, "p.txt", lambda p: read_postures(p, 6)),
        "text",
    )
    yield "lock", (this_process().encode(),), read_holder, "text"
    plant = (resources.files("armodal.hil_sim") / "plants" / "rv4frl.toml").read_bytes()
    yield "plant", (plant,), FileDecoder(folder, "plant.toml", load_plant_file), "text"
    write_rehearsal(Rehearsal(arm=arm, hidden=(("backlash", 1.0),)), folder / "r.json")
    rehearsal = (folder / "r.json").read_bytes()
    yield "rehearsal", (rehearsal,), FileDecoder(folder, "r.json", read_rehearsal), "text"


def _words(data: bytes) -> str:
    return data.decode(errors="replace")


def _tree(data: bytes) -> None:
    read_tree(_words(data), Path(), Remarks())


def _expand(path: Path) -> None:
    expanded(str(path), [], [])


def _motion(folder: Path, arm: Any) -> Iterator[Made]:
    """Logs of a second, in every format."""
    stamps = 10**18 + np.arange(250) * 4_000_000
    t = 1e-9 * (stamps - stamps[0])
    middle = np.array([np.mean(joint.range_rad) for joint in arm.joints])
    angles = middle + 0.1 * np.sin(6.0 * t[:, None] + np.arange(len(middle)))
    readings = np.sin(30.0 * t[:, None] + np.arange(3))
    topics = [
        ("/joint_states", [joint.name for joint in arm.joints], stamps, angles),
        ("/arm/acc_1", "tool", stamps, readings),
    ]
    names = ["time_s", *(f"{joint.name}_encoder_deg" for joint in arm.joints)]
    names += [f"acc_1_{axis}_m_s2" for axis in "xyz"]
    rows = np.column_stack([t, np.rad2deg(angles), readings])
    table = "\n".join([",".join(names), *(",".join(f"{x:.9g}" for x in row) for row in rows)])
    read = _reads_motion(arm)
    yield "motion table", (table.encode(),), FileDecoder(folder, "m.csv", read), "text"
    if not (find_spec("mcap") and find_spec("rosbags")):
        return
    for number, (kind, write) in enumerate(WRITERS.items()):
        made = write(folder / f"log-{number}", topics)
        if made.is_dir():
            (made,) = made.glob("*.db3")
        name = f"m{number}{made.suffix}"
        yield f"log, {kind}", (made.read_bytes(),), FileDecoder(folder, name, streams_of), "plain"


def _reads_motion(arm: Any) -> Callable[[Path], object]:
    return lambda path: read_motion_log(path, arm)


def _two_in_one(journal: bytes) -> bytes:
    """Two sessions one after the other, as a session that somebody wrote into."""
    session = decode_journal(journal)
    parts = [
        run_of(session.header, session.hits[:2], session_id=name, start_s=0.0)
        for name in ("aa", "bb")
    ]
    return MAGIC + b"".join(record for part in parts for record in part)


def _salvage(data: bytes) -> None:
    for session in salvage(InMemory(data)).sessions:
        decode_journal(b"".join(session.parts()))


def _rtde() -> bytes:
    sample = np.array([1], ">u1").tobytes() + np.arange(7, dtype=">f8").tobytes()
    sample += np.array([7, 1], ">u4").tobytes()
    types = b"\x01DOUBLE,VECTOR6D,INT32,UINT32"
    return (
        package("V", b"\x01") + package("O", types) + package("S", b"\x01") + package("U", sample)
    )


_READ = {
    RtdeKind.VERSION: decode_version,
    RtdeKind.OUTPUTS: decode_outputs,
    RtdeKind.START: decode_accepted,
    RtdeKind.DATA: lambda payload: decode_sample(payload, 1),
}


def _take_rtde(data: bytes) -> None:
    """As a listener does; one package that cannot be read does not hide the next."""
    for found in RtdeParser().feed(data):
        with suppress(ArmodalError):
            if found.kind is not None:
                _READ[found.kind](found.payload)


def mutation(kind: str) -> Callable[..., bytes]:
    """Return how seeds are made wrong."""
    return {
        "plain": lambda data, rng, others: mutated(data, rng, others=others),
        "text": lambda data, rng, others: mutated_text(data, rng, others=others),
        "hdf5": mutate_hdf5,
        "journal": mutate_journal,
    }[kind]
