"""Serial ports of this machine, as the operating system describes them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol

__all__ = ["FoundPort", "find_ports"]


class SystemPort(Protocol):
    """What pyserial tells of a port."""

    device: str
    description: str
    manufacturer: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundPort:
    """A serial port and the words its device describes itself with."""

    path: str
    description: str


def find_ports(
    list_all: Callable[[], Iterable[SystemPort]] | None = None,
) -> tuple[FoundPort, ...]:
    """Return the ports behind which a device has been found, by path.

    Ports of the machine itself that no device describes (``n/a``) are left out.
    """
    found = []
    for port in list_all() if list_all is not None else _all_ports():
        words = (port.manufacturer or "", port.description or "")
        description = " ".join(word for word in words if word and word != "n/a")
        if description:
            found.append(FoundPort(path=port.device, description=description))
    return tuple(sorted(found, key=lambda port: port.path))


def _all_ports() -> Iterable[SystemPort]:
    """Every port that the system lists; pyserial's lister is not there on every system."""
    from serial.tools import list_ports  # noqa: PLC0415 - see above

    ports: Iterable[SystemPort] = list_ports.comports()
    return ports
