"""The error types of armodal: one root, leaves that also are the builtin they resemble.

Every message says what was wanted, what came, and what to do.
"""

from __future__ import annotations

__all__ = [
    "ArmError",
    "ArmodalError",
    "BoardRefusedError",
    "CanError",
    "ControllerError",
    "DeviceLostError",
    "DeviceTimeoutError",
    "EstimateError",
    "ForeignFileError",
    "FrameError",
    "FrontEndError",
    "JournalError",
    "MissingPackageError",
    "PlanError",
    "PlantError",
    "PortError",
    "SessionError",
    "WrongSystemError",
]


class ArmodalError(Exception):
    """Root of all errors a user of armodal can be told about."""


class FrameError(ArmodalError, ValueError):
    """Bytes that are not a valid frame of the protocol."""


class PortError(ArmodalError, OSError):
    """A port that cannot be opened: not there, not a serial line, not allowed, or busy."""


class DeviceTimeoutError(ArmodalError, TimeoutError):
    """A device did not answer in time."""


class DeviceLostError(ArmodalError, ConnectionError):
    """A device that was there is gone, or is no longer the same."""


class BoardRefusedError(ArmodalError, ValueError):
    """The board refused a command and said why."""


class CanError(ArmodalError, ValueError):
    """A CAN database, adapter or frame that cannot be used."""


class ControllerError(ArmodalError, ValueError):
    """A robot's controller that cannot be listened to."""


class FrontEndError(ArmodalError, ValueError):
    """A front-end file, or what it names, that cannot be used."""


class ArmError(ArmodalError, ValueError):
    """An arm file, or what it refers to, that does not describe an arm."""


class PlanError(ArmodalError, ValueError):
    """A test plan that cannot be run."""


class JournalError(ArmodalError, ValueError):
    """A journal that is not one, or that belongs to something else."""


class MissingPackageError(ArmodalError, ImportError):
    """A package that this needs is not installed, or cannot be loaded."""


class SessionError(ArmodalError, ValueError):
    """A session file that cannot be used."""


class ForeignFileError(ArmodalError, ValueError):
    """A file of another program, or an import manifest, that cannot be used."""


class PlantError(ArmodalError, ValueError):
    """A plant file of the simulated laboratory that cannot be used."""


class WrongSystemError(ArmodalError, OSError):
    """The operating system has not what this needs."""


class EstimateError(ArmodalError, ValueError):
    """An estimate that failed; what was reached before is in `partial`."""

    def __init__(self, message: str, *, partial: object = None) -> None:
        super().__init__(message)
        self.partial = partial
