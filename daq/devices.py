"""What is there to measure with, what is missing, and how to get it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from armodal.daq.controller import controller_options
from armodal.daq.front_end.drivers.ni import ni_package
from armodal.daq.front_end.drivers.opendaq import opendaq_package
from armodal.daq.front_end.drivers.sound import sound_package
from armodal.daq.ports import FoundPort, find_ports
from armodal.protocols.c.build import compilers, is_current
from armodal.protocols.errors import MissingPackageError

__all__ = ["FoundDevice", "MissingDevice", "find_devices"]

NETWORKS = Path("/sys/class/net")
CAN_NETWORK = "280"  # ARPHRD_CAN of Linux, linux/if_arp.h


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundDevice:
    """A device, the address it is given by, and its own words."""

    kind: str  # "serial", "can", "sound", "ni", "opendaq"
    address: str
    description: str


@dataclass(frozen=True, slots=True, kw_only=True)
class MissingDevice:
    """A kind of device that cannot be looked for, or used, and what to do."""

    kind: str
    message: str


def find_devices(
    *,
    serial: Callable[[], tuple[FoundPort, ...]] = find_ports,
    networks: Path = NETWORKS,
) -> tuple[tuple[FoundDevice, ...], tuple[MissingDevice, ...]]:
    """Look for devices; none is opened. openDAQ asks its network who is there.

    Parameters
    ----------
    serial
        Lists serial ports.
    networks
        Where the system lists its network interfaces.
    """
    found = [
        FoundDevice(kind="serial", address=port.path, description=port.description)
        for port in serial()
    ]
    found += _can_networks(networks)
    missing = []
    looks: tuple[tuple[str, Callable[[], list[FoundDevice]]], ...] = (
        ("sound", _sound_cards),
        ("ni", _ni_modules),
        ("opendaq", _opendaq_devices),
    )
    for kind, look in looks:
        try:
            found += look()
        except MissingPackageError as error:
            missing.append(MissingDevice(kind=kind, message=str(error)))
    for kind, option in controller_options().items():
        try:
            if option.package is not None:
                option.package()
        except MissingPackageError as error:
            missing.append(MissingDevice(kind=kind, message=str(error)))
    if not is_current() and next(compilers(), None) is None:
        missing.append(
            MissingDevice(
                kind="front ends",
                message="wanted a C compiler for files, sound cards and NI, found none; install "
                "gcc or clang, or the package ziglang with pip",
            )
        )
    return tuple(found), tuple(missing)


def _can_networks(networks: Path) -> Iterator[FoundDevice]:
    for path in sorted(networks.glob("*/type")):
        try:
            is_can = path.read_text(encoding="ascii").strip() == CAN_NETWORK
            state = (path.parent / "operstate").read_text(encoding="ascii").strip()
        except OSError:
            continue  # taken away meanwhile
        if is_can:
            name = path.parent.name
            yield FoundDevice(kind="can", address=f"socketcan:{name}", description=state)


def _sound_cards() -> list[FoundDevice]:
    cards: list[Any] = list(sound_package().query_devices())
    return [
        FoundDevice(
            kind="sound",
            address=str(i),
            description=f"{card['name']}, {card['max_input_channels']} inputs",
        )
        for i, card in enumerate(cards)
        if card["max_input_channels"] > 0
    ]


def _opendaq_devices() -> list[FoundDevice]:
    instance = opendaq_package().Instance()
    return [
        FoundDevice(kind="opendaq", address=device.connection_string, description=device.name)
        for device in instance.available_devices
    ]


def _ni_modules() -> list[FoundDevice]:
    package = ni_package()
    try:
        devices = list(package.system.System.local().devices)
        return [
            FoundDevice(kind="ni", address=device.name, description=str(device.product_type))
            for device in devices
        ]
    except package.errors.DaqNotFoundError as error:
        raise MissingPackageError(
            "wanted the driver NI-DAQmx, it is not installed on this computer; get it from NI"
        ) from error
    except package.errors.DaqError as error:
        raise MissingPackageError(
            f"wanted the driver NI-DAQmx to list its devices, it says code {error.error_code}; NI "
            "MAX explains it"
        ) from error
