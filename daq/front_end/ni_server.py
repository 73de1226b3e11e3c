"""A module of NI at another computer: the package nidaqmx by the NI gRPC Device Server there."""

from __future__ import annotations

import importlib
import platform
from contextlib import suppress
from typing import Any

from armodal.daq.session_lock import lock_port
from armodal.protocols.errors import FrontEndError, MissingPackageError

__all__ = ["READ_EVERY_S", "NiServer"]

READ_EVERY_S = 0.02  # a call costs about a millisecond of processor time
CONNECT_WITHIN_S = 5.0
# Longer than any call needs; after it a network that has gone is told, not waited for.
ANSWER_WITHIN_S = 2.0


class NiServer:
    """A connection to a module at a server, as `192.168.1.20:31763`; without encryption.

    The server keeps a task whose program was killed, and the task keeps the module. So tasks have
    the name of this computer and the module: one that is left from before is cleared, and none
    can be in use, since one program of this computer at a time holds the module.

    Raises
    ------
    MissingPackageError, FrontEndError, PortError
        If the packages are not there, nobody answers, or another program of this computer holds
        the module.
    """

    def __init__(self, ni: Any, address: str, module: str) -> None:
        try:
            grpc = importlib.import_module("grpc")
        except ImportError as error:
            raise MissingPackageError(
                "wanted the package grpcio for a module at a server; install it with "
                "`pip install 'armodal[ni]'`"
            ) from error
        self._lock = lock_port(f"/{address}/{module}")
        self._channel = grpc.insecure_channel(address)
        try:
            grpc.channel_ready_future(self._channel).result(timeout=CONNECT_WITHIN_S)
        except grpc.FutureTimeoutError as error:
            self.close()
            raise FrontEndError(
                f"no NI gRPC Device Server answers at {address}: start it there, and check "
                "address, port and firewall"
            ) from error
        self._ni = ni
        self._limited = grpc.intercept_channel(self._channel, _deadline(grpc))
        self._name = f"armodal {platform.node()} {module}"

    def task(self) -> Any:
        """Make a task at the server; one of the same name that was left there is cleared."""
        kinds = importlib.import_module("nidaqmx.grpc_session_options")
        behaviours = kinds.SessionInitializationBehavior
        with suppress(self._ni.errors.Error):  # there is none, as a rule
            self._named(behaviours.ATTACH_TO_SERVER_SESSION).close()
        return self._named(behaviours.INITIALIZE_SERVER_SESSION)

    def anonymous(self) -> Any:
        """Options of what is no task."""
        return self._ni.GrpcSessionOptions(self._limited, "")

    def close(self) -> None:
        """Let go of the connection."""
        self._channel.close()
        self._lock.release()

    def _named(self, behaviour: Any) -> Any:
        options = self._ni.GrpcSessionOptions(
            self._limited, self._name, initialization_behavior=behaviour
        )
        return self._ni.Task(self._name, grpc_options=options)


def _deadline(grpc: Any) -> Any:
    class Deadline(grpc.UnaryUnaryClientInterceptor):  # type: ignore[misc]  # a class of grpc
        """Give every call a time within which it must be answered."""

        def intercept_unary_unary(self, continuation: Any, details: Any, request: Any) -> Any:
            return continuation(_Details(details), request)

    class _Details(grpc.ClientCallDetails):  # type: ignore[misc]  # likewise
        def __init__(self, of: Any) -> None:
            self.method, self.metadata, self.credentials = of.method, of.metadata, of.credentials
            self.wait_for_ready, self.compression = of.wait_for_ready, of.compression
            self.timeout = ANSWER_WITHIN_S

    return Deadline()
