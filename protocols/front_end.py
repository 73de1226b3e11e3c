"""Front-end files: which device digitises, and which sensor is at which of its inputs.

The format is specified in `docs/front-ends.md`.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from armodal.protocols.board.records import Channel, IepeState
from armodal.protocols.board.samples import COUNT_MAX
from armodal.protocols.errors import FrontEndError
from armodal.protocols.toml_reader import (
    FileModel,
    Name,
    parse_toml,
    read_text,
    refuse,
    validate,
)

__all__ = ["FrontEnd", "front_end_from_text", "load_front_end"]

_LIMIT = 128 * 1024
_UNITS = {"force": "N", "acceleration": "m/s^2"}
_SOURCES = {  # of devices that need one
    "replay": "the file to replay",
    "ni": "a module, such as cDAQ1Mod1",
    "opendaq": "a connection string, such as daq.nd://192.168.1.20",
}
_COUNTED = {"replay": True, "sound": True, "ni": False, "opendaq": False}  # inputs are numbers

Positive = Annotated[float, Field(gt=0.0)]
Text = Annotated[str, Field(max_length=32)]


class _ChannelTable(FileModel):
    name: Name
    quantity: Literal["force", "acceleration"]
    input: Annotated[int, Field(ge=1, le=64)] | Name
    full_scale: float | None = None  # N or m/s^2 at the largest number; below 0 where it inverts
    sensitivity_mv: float | None = None  # mV per N or per m/s^2; below 0 where it inverts
    iepe_ma: Positive | None = None
    highpass_hz: Annotated[float, Field(ge=0.0)] = 0.0
    serial_number: Text = ""
    calibration_date: str = ""


class _FrontEndTable(FileModel):
    format: Literal["armodal-front-end-1"]
    device: Name  # a driver; whoever opens it knows which there are
    source: Annotated[str, Field(max_length=256)] = ""
    server: Annotated[str, Field(pattern=r"^$|^[^\s:]+:[0-9]{1,5}$|^\[[^\s\]]+\]:[0-9]{1,5}$")] = ""
    range_v: Positive | None = None
    filter_group_delay_samples: Annotated[float, Field(ge=0.0)] = 0.0
    channels: Annotated[list[_ChannelTable], Field(min_length=2, max_length=32)]


@dataclass(frozen=True, slots=True, kw_only=True)
class FrontEnd:
    """What a front-end file says.

    source : the file to replay, the sound device, or the module's name in the driver
    server : host and port of the NI gRPC Device Server that has the module; empty: this computer
    channels : as a board would describe them; a count is `scale` of its unit
    inputs : of each channel, a number from 1 on, or a name of the device's
    sensitivity_mv : of each channel, mV per N or per m/s^2; None where no volts are known
    iepe_ma : of each channel, current of the sensor's supply; None where it is off
    range_v : largest input voltage
    """

    name: str
    device: str
    source: str
    server: str
    channels: tuple[Channel, ...]
    inputs: tuple[int | str, ...]
    sensitivity_mv: tuple[float | None, ...]
    iepe_ma: tuple[float | None, ...]
    range_v: float | None
    filter_group_delay_samples: float


def load_front_end(path: Path) -> FrontEnd:
    """Read a front-end file; a file it names lies beside it.

    Raises
    ------
    FrontEndError
        If it cannot be read, or a value is not possible; the message has the key's path.
    """
    text = read_text(path, what="front-end file", limit_bytes=_LIMIT, error=FrontEndError)
    found = front_end_from_text(text, name=path.stem, origin=f"front-end file {path.name}")
    if found.device != "replay":
        return found
    if Path(found.source).name != found.source:
        refuse(
            FrontEndError,
            f"front-end file {path.name}",
            "source",
            wanted="the name of a file beside it, without a folder",
            got=found.source,
        )
    values = {key: getattr(found, key) for key in found.__slots__}
    return FrontEnd(**(values | {"source": str(path.parent / found.source)}))


def front_end_from_text(text: str, *, name: str, origin: str) -> FrontEnd:
    """Return what the text of a front-end file says, or raise FrontEndError."""
    data = parse_toml(text, origin=origin, error=FrontEndError)
    table = validate(_FrontEndTable, data, origin=origin, error=FrontEndError)
    _check_devices(table, origin)
    names = [channel.name for channel in table.channels]
    inputs = [channel.input for channel in table.channels]
    for key, values in (("name", names), ("input", inputs)):
        twice = [i for i, value in enumerate(values) if value in values[:i]]
        if twice:
            path = f"channels[{twice[0]}].{key}"
            refuse(FrontEndError, origin, path, wanted="each once", got=values[twice[0]])
    return FrontEnd(
        name=name,
        device=table.device,
        source=table.source,
        server=table.server,
        channels=tuple(
            _channel(channel, table, f"channels[{i}]", origin)
            for i, channel in enumerate(table.channels)
        ),
        inputs=tuple(inputs),
        sensitivity_mv=tuple(channel.sensitivity_mv for channel in table.channels),
        iepe_ma=tuple(channel.iepe_ma for channel in table.channels),
        range_v=table.range_v,
        filter_group_delay_samples=table.filter_group_delay_samples,
    )


def _check_devices(table: _FrontEndTable, origin: str) -> None:
    """Refuse what a device that is known here has not."""
    if table.device in _SOURCES and not table.source:
        refuse(FrontEndError, origin, "source", wanted=_SOURCES[table.device], got=table.source)
    if table.server and table.device != "ni":
        refuse(
            FrontEndError, origin, "server", wanted='none unless device is "ni"', got=table.server
        )
    for i, channel in enumerate(table.channels):
        counted = _COUNTED.get(table.device, isinstance(channel.input, int))
        if isinstance(channel.input, int) != counted:
            wanted = "a number, 1 for the first" if counted else "a name of the device's, as ai0"
            refuse(FrontEndError, origin, f"channels[{i}].input", wanted=wanted, got=channel.input)
        if table.device == "ni" and channel.sensitivity_mv is None:
            path = f"channels[{i}].sensitivity_mv"
            refuse(FrontEndError, origin, path, wanted="mV per N or per m/s^2", got=None)


def _channel(channel: _ChannelTable, table: _FrontEndTable, path: str, origin: str) -> Channel:
    """Return the channel as a board would describe it."""
    full_scale = channel.full_scale
    if (full_scale is None) == (channel.sensitivity_mv is None):
        got = "neither" if full_scale is None else "both"
        wanted = "full_scale or sensitivity_mv"
        refuse(FrontEndError, origin, path, wanted=wanted, got=got)
    if full_scale is None and channel.sensitivity_mv:
        if table.range_v is None:
            refuse(FrontEndError, origin, "range_v", wanted="the inputs' largest voltage", got=None)
        full_scale = 1e3 * table.range_v / channel.sensitivity_mv
    if not full_scale:
        refuse(
            FrontEndError, origin, path, wanted="a full scale or sensitivity that is not 0", got=0
        )
    if channel.calibration_date:
        try:
            date.fromisoformat(channel.calibration_date)
        except ValueError:
            wanted, got = "a date, as 2026-03-02", channel.calibration_date
            refuse(FrontEndError, origin, f"{path}.calibration_date", wanted=wanted, got=got)
    return Channel(
        name=channel.name,
        quantity=channel.quantity,
        unit=_UNITS[channel.quantity],
        scale=full_scale / COUNT_MAX,
        full_scale=abs(full_scale),
        iepe=IepeState.OFF if channel.iepe_ma is None else IepeState.OK,
        highpass_hz=channel.highpass_hz,
        serial_number=channel.serial_number,
        calibration_date=channel.calibration_date,
        teds=b"",
    )
