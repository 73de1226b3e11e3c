"""A module of NI at another computer: the package nidaqmx by the NI gRPC Device Server there."""

from __future__ import annotations

import importlib
from typing import Any

from armodal.protocols.errors import FrontEndError, MissingPackageError

__all__ = ["READ_EVERY_S", "NiServer"]

READ_EVERY_S = 0.02  # a call costs about a millisecond of processor time
CONNECT_WITHIN_S = 5.0
# Longer than any call needs; after it a network that has gone is told, not waited for.
ANSWER_WITHIN_S = 2.0


class NiServer:
    """A connection to the server at `address`, as `192.168.1.20:31763`; without encryption.

    Attributes
    ----------
    options : dict
        What a task of nidaqmx is made with.

    Raises
    ------
    MissingPackageError, FrontEndError
        If the packages are not there, or nobody answers.
    """

    def __init__(self, ni: Any, address: str) -> None:
        try:
            grpc = importlib.import_module("grpc")
        except ImportError as error:
            raise MissingPackageError(
                "wanted the package grpcio for a module at a server; install it with "
                "`pip install 'armodal[ni]'`"
            ) from error
        self._channel = grpc.insecure_channel(address)
        try:
            grpc.channel_ready_future(self._channel).result(timeout=CONNECT_WITHIN_S)
        except grpc.FutureTimeoutError as error:
            self._channel.close()
            raise FrontEndError(
                f"no NI gRPC Device Server answers at {address}: start it there, and check "
                "address, port and firewall"
            ) from error
        limited = grpc.intercept_channel(self._channel, _deadline(grpc))
        self.options = {"grpc_options": ni.GrpcSessionOptions(limited, "")}

    def close(self) -> None:
        """Let go of the connection."""
        self._channel.close()


def _deadline(grpc: Any) -> Any:
    class Deadline(grpc.UnaryUnaryClientInterceptor):  # type: ignore[misc]  # a class of grpc
        """Give every call a time within which it must be answered."""

        def intercept_unary_unary(self, continuation: Any, details: Any, request: Any) -> Any:
            return continuation(_Details(details), request)

    class _Details(grpc.ClientCallDetails):  # type: ignore[misc]
        def __init__(self, of: Any) -> None:
            self.method, self.metadata, self.credentials = of.method, of.metadata, of.credentials
            self.wait_for_ready, self.compression = of.wait_for_ready, of.compression
            self.timeout = ANSWER_WITHIN_S

    return Deadline()
