"""`armodal can`: learn what a controller says on its bus, by listening."""

from __future__ import annotations

import math
import select
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tomlkit
import typer
from rich.table import Table

from armodal.daq.can_learning import Learned, Station, can_section_text, database_text, learn
from armodal.daq.can_listener import CanSource, open_can
from armodal.daq.clock import SystemClock
from armodal.protocols.arm.files import arm_from_texts, load_arm
from armodal.protocols.arm.records import Arm, CanMapping
from armodal.protocols.can_database import CanDecoder
from armodal.protocols.can_records import CanFrame
from armodal.protocols.errors import CanError, SessionError
from armodal.protocols.text_file import replace_text
from armodal.tui.console import Json, TimeScale, err, out, print_json, say, say_next
from armodal.tui.this_system import check_runs_devices

__all__ = ["app"]

LEAST_MOVE_DEG = 5.0
EMPTYING_WALL_S = 1.0  # some 12 KB at a serial line's 115 200 bit/s: pty, driver and adapter
FAILED = 1

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    help="The CAN bus of a robot controller.\n\nExample: armodal can learn /dev/ttyACM1",
)


@app.callback()
def _can() -> None:
    """Say what a controller says on its CAN bus."""


@app.command("learn")
def learn_command(
    channel: Annotated[str, typer.Argument(help="slcan port, or interface:channel.")],
    arm: Annotated[str, typer.Option(help="Arm file or shipped arm.")] = "rv4frl",
    bitrate: Annotated[int, typer.Option(min=10_000, help="Bit rate of the bus, bit/s.")] = 500_000,
    folder: Annotated[
        Path,
        typer.Option(
            "--out", help="Folder for the DBC file and the [can] section; never overwritten."
        ),
    ] = Path(),
    seconds: Annotated[float, typer.Option(min=0.1, help="Listening time at each stop, s.")] = 1.0,
    time_scale: TimeScale = 1.0,
    as_json: Json = False,
) -> None:
    """Learn which frames carry which joint's angle, and check it against the pendant.

    You move one joint at a time with the pendant and type the angle it shows; the program
    only listens to the bus and never sends. At the end you move all joints, and the result is
    compared with the pendant. Exit code 1 if a joint is missing or the angles disagree.

    Example: armodal can learn /dev/ttyACM1 --arm ur5 --out my-arm
    """
    check_runs_devices("can learn")
    the_arm = load_arm(arm)
    paths = {name: folder / f"{the_arm.name}{name}" for name in (".dbc", ".can.toml")}
    if taken := [str(path) for path in paths.values() if path.exists()]:
        raise SessionError(
            f"wanted a folder without {' and '.join(taken)}, which are not replaced; give another "
            "with --out"
        )
    clock = SystemClock(scale=time_scale)
    source = open_can(channel, bitrate)
    try:
        if not source.confirmed_silent:
            say("the adapter does not say that it only listens: see docs/can-listen-only.md")

        def hear() -> tuple[CanFrame, ...]:
            return _heard(source, clock, seconds)

        places = _Places(the_arm)
        stations = _stations(places, hear)
        learned = learn(
            stations,
            [joint.name for joint in the_arm.joints],
            places.ranges_deg,
            rounding_deg=places.rounding_deg,
        )
        for name, why in learned.missing.items():
            err.print(f"{name}: {why}")
        differences = {}
        mapping = None
        if not learned.missing:
            rate_hz = _rate_hz(learned, stations, seconds)
            mapping = _written(learned, the_arm, paths, bitrate=bitrate, rate_hz=rate_hz)
            say("now move all joints to another place, as a check")
            shown = places.ask_all()
            differences = _differences(mapping, hear(), shown, the_arm)
    finally:
        source.close()
    _show(learned, differences, paths if mapping else {}, places.rounding_deg, as_json=as_json)
    allowed = {j.joint: j.error_deg + places.rounding_deg for j in learned.joints}
    wrong = [name for name, off in differences.items() if not abs(off) <= allowed[name]]
    if wrong:
        err.print(
            f"{', '.join(wrong)}: pendant and bus disagree; learn again with larger moves, to both "
            "sides of zero"
        )
    if learned.missing or wrong:
        raise typer.Exit(FAILED)
    section = paths[".can.toml"]
    say_next(f"check can {channel} --arm ARM", f"once {section} is copied into the arm file")


class _Places:
    """What is typed of the pendant, joint by joint."""

    def __init__(self, arm: Arm) -> None:
        self.names = [joint.name for joint in arm.joints]
        self.ranges_deg = [
            (math.degrees(low), math.degrees(high))
            for low, high in (j.range_rad for j in arm.joints)
        ]
        self.rounding_deg = 0.0
        self._decimals = 0

    def ask_all(self) -> tuple[float, ...]:
        """Ask for the angles of all joints."""
        n = len(self.names)
        while True:
            texts = err.input(f"All {n} joint angles the pendant shows, base outwards, in deg: ")
            values = self._read(texts.replace(",", " ").split())
            if values is not None and len(values) == n:
                return tuple(values)
            err.print(f"wanted {n} numbers, such as {' '.join(['0.0'] * n)}, got {texts!r}")

    def ask_one(self, number: int, now: tuple[float, ...], which: str) -> tuple[float, ...]:
        """Ask for one joint's angle after it alone was moved."""
        name = self.names[number]
        while True:
            text = err.input(f"Move {name} alone, {which}; its angle now in deg: ")
            values = self._read([text.strip()])
            if values is not None and abs(values[0] - now[number]) >= LEAST_MOVE_DEG:
                return (*now[:number], values[0], *now[number + 1 :])
            err.print(f"wanted one number at least {LEAST_MOVE_DEG:g} from {now[number]:g}")

    def _read(self, texts: list[str]) -> list[float] | None:
        try:
            values = [float(text) for text in texts]
        except ValueError:
            return None
        if not values or not all(math.isfinite(value) for value in values):
            return None
        # The coarsest number is not known to be rounded: the finest shows what the pendant shows.
        self._decimals = max(self._decimals, *(len(t.partition(".")[2]) for t in texts))
        self.rounding_deg = 0.5 * 10.0**-self._decimals
        return values


def _stations(places: _Places, hear: Callable[[], tuple[CanFrame, ...]]) -> list[Station]:
    """Every joint at three angles, moved alone."""
    say("bring the arm to rest; it must stand still whenever you press Enter")
    now = places.ask_all()
    stations = [Station(joints_deg=now, frames=hear())]
    for number in range(len(places.names)):
        for which in ("by 20 deg or more", "to the other side of zero, 20 deg or more"):
            now = places.ask_one(number, now, which)
            stations.append(Station(joints_deg=now, frames=hear()))
    return stations


def _heard(source: CanSource, clock: SystemClock, lab_s: float) -> tuple[CanFrame, ...]:
    """Frames from now on; what waited in the adapter's and the system's buffers is thrown away."""
    now_s = clock.now_s()
    begin_s = now_s + EMPTYING_WALL_S / clock.wall_s(1.0)
    frames: list[CanFrame] = []
    end_s = begin_s + lab_s
    while (left_s := end_s - now_s) > 0.0:
        if source.fileno() >= 0:
            select.select([source.fileno()], [], [], clock.wall_s(left_s))
        else:
            clock.sleep(min(left_s, 0.002))
        now_s = clock.now_s()
        source.collect(now_s)
        heard = [frame for _, some in source.take() for frame in some]
        frames += heard if now_s >= begin_s else []
    return tuple(frames)


def _rate_hz(learned: Learned, stations: list[Station], seconds: float) -> float:
    """Frames of the slowest message a lab second."""
    keys = {(joint.field.can_id, joint.field.extended) for joint in learned.joints}
    heard = [(f.can_id, f.extended) for station in stations for f in station.frames]
    return min(heard.count(key) for key in keys) / (len(stations) * seconds)


def _written(
    learned: Learned, arm: Arm, paths: dict[str, Path], *, bitrate: int, rate_hz: float
) -> CanMapping:
    """Write both files, once they have been read as an arm's; return the mapping."""
    database = database_text(learned)
    section = can_section_text(
        learned, database=paths[".dbc"].name, bitrate=bitrate, rate_hz=rate_hz
    )
    bare = arm.text if arm.can is None else _without_can(arm.text)
    read = arm_from_texts(
        f"{bare.rstrip()}\n\n{section}", urdf_text=arm.urdf_text, database_text=database
    )
    if read.can is None:
        raise CanError("wanted the learned section in the arm, got none")
    paths[".dbc"].parent.mkdir(parents=True, exist_ok=True)
    replace_text(paths[".dbc"], database)
    replace_text(paths[".can.toml"], section)
    return read.can


def _without_can(text: str) -> str:
    document = tomlkit.parse(text)
    document.pop("can")
    return tomlkit.dumps(document)


def _differences(
    mapping: CanMapping, frames: tuple[CanFrame, ...], shown: tuple[float, ...], arm: Arm
) -> dict[str, float]:
    """Bus minus pendant in degrees, nan of a joint that was not heard."""
    decoder = CanDecoder(replace(mapping, counter=None))
    heard: dict[str, list[float]] = {joint.name: [] for joint in arm.joints}
    for frame in frames:
        update = decoder.decode(frame)
        for name, angle in ({} if update is None else update.joints_rad).items():
            heard[name].append(math.degrees(angle))
    return {
        name: float(np.median(angles)) - wanted if angles else math.nan
        for (name, angles), wanted in zip(heard.items(), shown, strict=True)
    }


def _show(
    learned: Learned,
    differences: dict[str, float],
    paths: dict[str, Path],
    rounding_deg: float,
    *,
    as_json: bool,
) -> None:
    if as_json:
        print_json(_as_json(learned, differences, paths))
        return
    table = Table(title="Learned of the bus, in degrees")
    columns = ("joint", "where", "one count", "zero", "sure to", "bus - pendant")
    for column in columns:
        table.add_column(column)
    for joint in learned.joints:
        off = differences.get(joint.joint)
        table.add_row(
            joint.joint,
            joint.field.words(),
            f"{joint.factor_deg:.7g}" + ("" if joint.is_round else " (fitted)"),
            f"{joint.offset_deg:g}",
            f"{joint.error_deg:.2g}",
            "" if off is None else f"{off:+.3f}",
        )
    table.caption = f"the pendant rounds to {2.0 * rounding_deg:g}"
    out.print(table)
    for joint in learned.joints:
        for field in joint.also:
            out.print(f"{joint.joint} also stands in {field.words()}")
    out.print("the drive state cannot be learned: add it by the controller's manual (docs/can.md)")
    for path in paths.values():
        out.print(f"written {path}")


def _as_json(
    learned: Learned, differences: dict[str, float], paths: dict[str, Path]
) -> dict[str, Any]:
    return {
        "joints": [
            {
                "joint": joint.joint,
                "can_id": joint.field.can_id,
                "extended": joint.field.extended,
                "first_byte": joint.field.first_byte,
                "bytes": joint.field.format.n_bytes,
                "little_endian": joint.field.format.little_endian,
                "kind": str(joint.field.format.kind),
                "factor_deg": joint.factor_deg,
                "offset_deg": joint.offset_deg,
                "round": joint.is_round,
                "residual_deg": joint.residual_deg,
                "error_deg": joint.error_deg,
                "also": [field.words() for field in joint.also],
                "bus_minus_pendant_deg": differences.get(joint.joint),
            }
            for joint in learned.joints
        ],
        "missing": dict(learned.missing),
        "files": [str(path) for path in paths.values()],
    }
