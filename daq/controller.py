"""What tells joint angles in place of the bus: `controllers` is searched for its modules."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pkgutil import iter_modules
from typing import Protocol

from armodal.daq import controllers
from armodal.daq.joint_source import JointSource
from armodal.protocols.arm.records import Arm

__all__ = [
    "AtAddress",
    "Controller",
    "ControllerOption",
    "controller_options",
    "without_bus_options",
]


class Controller(Protocol):
    """A controller as the user named it; it is sent to the acquisition process and opened there."""

    @property
    def address(self) -> str:
        """Where it is, for the screens."""

    def open(self, arm: Arm) -> JointSource:
        """Return its angles as a source.

        Raises
        ------
        ArmError, ControllerError, DeviceTimeoutError, DeviceLostError, MissingPackageError
            If the arm is not its own, or it cannot be reached or understood.
        """


@dataclass(frozen=True, slots=True, kw_only=True)
class AtAddress:
    """A controller whose source needs its address and the arm; a function that can be pickled."""

    address: str
    source: Callable[[str, Arm], JointSource]

    def open(self, arm: Arm) -> JointSource:
        """Return its angles as a source."""
        return self.source(self.address, arm)


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerOption:
    """The option of `armodal acquire` and `armodal run`; its module's name is its own.

    metavar : what the option takes
    help : its line in the help, behind "Without a bus: "
    controller : from what was given to the controller; ArmodalError for what cannot be meant
    package : imports a package that it needs; MissingPackageError where that is not installed
    """

    metavar: str
    help: str
    controller: Callable[[str], Controller]
    package: Callable[[], object] | None = None


@lru_cache(maxsize=1)
def controller_options() -> dict[str, ControllerOption]:
    """Return every option by its name."""
    names = [module.name for module in iter_modules(controllers.__path__)]
    return {name: import_module(f"{controllers.__name__}.{name}").OPTION for name in sorted(names)}


def without_bus_options() -> str:
    """Return in words the options that tell where joint angles come from without a bus."""
    every = (f"--{name} {option.metavar}" for name, option in controller_options().items())
    return f"{', '.join(every)}, or --by-hand with the degrees to which you read them"
