"""Open the device that a front-end file names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from armodal.daq.clock import Clock
from armodal.daq.front_end.board import FrontEndPort
from armodal.daq.front_end.ni import NiModule
from armodal.daq.front_end.opendaq import OpenDaqDevice
from armodal.daq.front_end.replay import Replay
from armodal.daq.front_end.sound import SoundCard
from armodal.daq.front_end.source import SampleSource
from armodal.protocols.front_end import FrontEnd, load_front_end

__all__ = ["is_front_end", "open_front_end", "open_source"]

_SOURCES: dict[str, Callable[[FrontEnd], SampleSource]] = {
    "replay": Replay,
    "sound": SoundCard,
    "ni": NiModule,
    "opendaq": OpenDaqDevice,
}


def is_front_end(port: str) -> bool:
    """Whether what is given as the board's port is a front-end file."""
    return port.endswith(".toml")


def open_source(front_end: FrontEnd) -> SampleSource:
    """Open the device; errors are those of its driver."""
    return _SOURCES[front_end.device](front_end)


def open_front_end(path: Path, clock: Clock) -> FrontEndPort:
    """Open the device of a front-end file as a board.

    Raises
    ------
    FrontEndError, MissingPackageError, DeviceLostError, ForeignFileError, CompilerError
        If the file, the driver or the device cannot be used.
    """
    front_end = load_front_end(path)
    source = open_source(front_end)
    try:
        return FrontEndPort(front_end, source, clock)
    except BaseException:
        source.close()
        raise
