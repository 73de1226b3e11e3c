"""Open the device that a front-end file names."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from armodal.daq.clock import Clock
from armodal.daq.front_end import drivers
from armodal.daq.front_end.board import FrontEndPort
from armodal.daq.front_end.source import SampleSource
from armodal.protocols.errors import FrontEndError
from armodal.protocols.front_end import FrontEnd, load_front_end

__all__ = ["is_front_end", "open_front_end", "open_source"]


def is_front_end(port: str) -> bool:
    """Whether what is given as the board's port is a front-end file."""
    return port.endswith(".toml")


def open_source(front_end: FrontEnd) -> SampleSource:
    """Open the device; errors are those of its driver.

    Raises
    ------
    FrontEndError
        If there is no driver of that name.
    """
    names = [module.name for module in iter_modules(drivers.__path__)]
    if front_end.device not in names:
        raise FrontEndError(
            f"front-end file {front_end.name}: device: wanted one of {', '.join(names)}, got "
            f"{front_end.device}; correct it"
        )
    driver: Callable[[FrontEnd], SampleSource] = import_module(
        f"{drivers.__name__}.{front_end.device}"
    ).DRIVER
    return driver(front_end)


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
