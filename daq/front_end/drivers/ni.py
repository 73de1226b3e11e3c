"""A module of NI with IEPE inputs, by NI-DAQmx and its package nidaqmx: hardware-timed.

Not yet on a real module: it is tested against a fake of the package's interface, and with the
package itself by a gRPC server of the public protocol.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from fractions import Fraction
from typing import Any

import numpy as np

from armodal.daq.front_end.ni_server import READ_EVERY_S, NiServer
from armodal.daq.front_end.source import Chunk, to_counts
from armodal.daq.front_end.timing import SampleTimes
from armodal.protocols.errors import DeviceLostError, FrontEndError, MissingPackageError
from armodal.protocols.front_end import FrontEnd

__all__ = ["DRIVER", "NiModule", "ni_package"]

STANDARD_GRAVITY_M_S2 = 9.80665  # of the driver's mV/g (3rd CGPM, 1901)
BUFFER_S = 10.0
RATE_TOLERANCE = 1e-9  # relative: rates are told as doubles
OVERWRITTEN = -200279
MOST_READ = 2**18  # values at once: 2 MB, half of what gRPC takes in one message

# What a module finds of a sensor's circuit, by the driver's property of that name.
_CIRCUIT_FAULTS = {
    "open_current_loop_chans": "is open",
    "excit_fault_chans": "is at fault, most often a short",
}
# What the driver's codes mean to an operator (NI-DAQmx, Error Codes).
_MEANINGS = {
    -200220: "there is no such device; NI MAX, or `armodal devices`, shows the names",
    -200170: "there is no such input; the inputs are called ai0, ai1, ...",
    -50103: "another program holds it; close that",
    -200022: "another program holds it; close that",
    -200431: "this input cannot measure that; it wants IEPE inputs, as those of an NI 9234",
    -200077: "this module cannot do what the front-end file asks; look at range_v and iepe_ma",
    -201003: "it cannot be reached; check its power and cable",
    OVERWRITTEN: "samples were overwritten before they were read: the computer was held up",
}


def ni_package() -> Any:
    """Return the package nidaqmx, or raise MissingPackageError saying how to get it."""
    try:
        return importlib.import_module("nidaqmx")
    except ImportError as error:
        raise MissingPackageError(
            "wanted the package nidaqmx for a device of NI, it is not installed; install it with "
            "`pip install 'armodal[ni]'`, and the driver NI-DAQmx from NI"
        ) from error


class NiModule:
    """The IEPE inputs of one module, of this computer or of a server.

    Raises
    ------
    MissingPackageError, FrontEndError, DeviceLostError
        If package, driver, module or input are not there, or an input is of another kind.
    """

    def __init__(self, front_end: FrontEnd) -> None:
        self._ni = ni_package()
        self._constants = importlib.import_module("nidaqmx.constants")
        readers = importlib.import_module("nidaqmx.stream_readers")
        self.name = front_end.source
        self.driver = f"nidaqmx {self._ni.__version__}"
        self._times: SampleTimes | None = None
        self._read_s = -np.inf
        # A count is a part of the range in volts: sensitivities, which the driver is given without
        # their sign, are divided out again.
        self._to_full_scale = np.array([1.0 / channel.full_scale for channel in front_end.channels])
        self._server = NiServer(self._ni, front_end.server, self.name) if front_end.server else None
        self._task: Any = None
        try:
            with self._told():
                self._task = self._server.task() if self._server else self._ni.Task()
            with self._told():
                for i in range(len(front_end.channels)):
                    self._add(front_end, i)
                self._reader = readers.AnalogMultiChannelReader(self._task.in_stream)
            self.teds = tuple(self._teds(name) for name in front_end.inputs)
        except BaseException:
            self.close()
            raise

    def rate_refusal(self, rate_hz: Fraction) -> str:
        """Return which rate the module makes in place of this one."""
        with self._told():
            made_hz = self._configure(float(rate_hz))
        if abs(made_hz / float(rate_hz) - 1.0) <= RATE_TOLERANCE:
            return ""
        return f"{self.name} makes {made_hz:.9g} Hz instead"

    def start(self, rate_hz: Fraction, now_s: float) -> None:
        """Start the task."""
        with self._told():
            self._configure(float(rate_hz))
            self._task.start()
            self._check_sensors()
        self._times = SampleTimes(self.name, float(rate_hz), now_s)

    def stop(self) -> None:
        """Stop the task."""
        if self._times is not None:
            self._times = None
            with self._told():
                self._task.stop()

    def read(self, now_s: float) -> list[Chunk]:
        """Return the samples that wait in the driver's buffer."""
        times = self._times
        if times is None or (self._server and now_s - self._read_s < READ_EVERY_S):
            return []
        self._read_s = now_s
        with self._told(lost=True):
            n = int(self._task.in_stream.avail_samp_per_chan)
            n = min(n, MOST_READ // len(self._to_full_scale))
            values = np.empty((len(self._to_full_scale), n))
            if n:
                self._reader.read_many_sample(values, n, timeout=0.0)
        if not n:
            times.check(now_s)
            return []
        counts = to_counts(values.T * self._to_full_scale)
        return [Chunk(counts=counts, ready_s=times.add(n, now_s))]

    def close(self) -> None:
        """Let go of the module."""
        self._times = None
        if self._task is not None:
            with suppress(self._ni.errors.Error):  # of a device or server that has gone
                self._task.close()
        if self._server:
            self._server.close()

    def _add(self, front_end: FrontEnd, i: int) -> None:
        channel, sensitivity_mv = front_end.channels[i], abs(front_end.sensitivity_mv[i] or 0.0)
        iepe_ma, constants = front_end.iepe_ma[i], self._constants
        source = constants.ExcitationSource
        shared = {
            "min_val": -channel.full_scale,
            "max_val": channel.full_scale,
            "current_excit_source": source.NONE if iepe_ma is None else source.INTERNAL,
            "current_excit_val": 0.0 if iepe_ma is None else 1e-3 * iepe_ma,
        }
        channels, place = self._task.ai_channels, f"{front_end.source}/{front_end.inputs[i]}"
        if channel.quantity == "force":
            channels.add_ai_force_iepe_chan(
                place,
                units=constants.ForceUnits.NEWTONS,
                sensitivity=sensitivity_mv,
                sensitivity_units=constants.ForceIEPESensorSensitivityUnits.MILLIVOLTS_PER_NEWTON,
                **shared,
            )
        else:
            channels.add_ai_accel_chan(
                place,
                units=constants.AccelUnits.METERS_PER_SECOND_SQUARED,
                sensitivity=sensitivity_mv * STANDARD_GRAVITY_M_S2,
                sensitivity_units=constants.AccelSensitivityUnits.MILLIVOLTS_PER_G,
                **shared,
            )

    def _teds(self, place: int | str) -> bytes:
        """Return the data sheet of the sensor at an input; empty where it has none to be read."""
        channels = importlib.import_module("nidaqmx.system.physical_channel")
        options = self._server.anonymous() if self._server else None
        channel = channels.PhysicalChannel(f"{self.name}/{place}", grpc_options=options)
        try:
            channel.configure_teds()
            return bytes(channel.teds_bit_stream)
        except self._ni.errors.Error:
            return b""  # of a sensor without one, or a module that does not look

    def _configure(self, rate_hz: float) -> float:
        """Ask for a rate; return the one that is made."""
        self._task.timing.cfg_samp_clk_timing(
            rate_hz,
            sample_mode=self._constants.AcquisitionType.CONTINUOUS,
            samps_per_chan=round(BUFFER_S * rate_hz),
        )
        return float(self._task.timing.samp_clk_rate)

    def _check_sensors(self) -> None:
        """Refuse to measure with a sensor that is not there, where the module can tell."""
        for named, fault in _CIRCUIT_FAULTS.items():
            stream = self._task.in_stream
            try:
                # The driver tells the names only to who has asked whether there are any.
                is_there = bool(getattr(stream, f"{named}_exist"))
                names = list(getattr(stream, named)) if is_there else []
            except self._ni.errors.DaqError:
                continue  # this module does not look
            if names:
                self._task.stop()
                raise FrontEndError(
                    f"{self.name}: the sensor circuit of {', '.join(map(str, names))} {fault}: "
                    "check sensor and cable"
                )

    @contextmanager
    def _told(self, *, lost: bool = False) -> Iterator[None]:
        """Turn what the driver raises into one sentence."""
        errors = self._ni.errors
        try:
            yield
        except errors.DaqNotFoundError as error:
            raise MissingPackageError(
                "wanted the driver NI-DAQmx, it is not installed on this computer; get it from NI"
            ) from error
        except errors.RpcError as error:
            raise (DeviceLostError if lost else FrontEndError)(
                f"{self.name}: the NI gRPC Device Server does not do what is asked "
                f"({getattr(error.rpc_code, 'name', error.rpc_code)}); check it and the network"
                f"{'; then resume' if lost else ''}"
            ) from error
        except errors.DaqError as error:
            code = int(error.error_code)
            means = _MEANINGS.get(code, f"the driver says code {code}, which NI MAX explains")
            gone = lost or code in {-201003, OVERWRITTEN}
            kind = DeviceLostError if gone else FrontEndError
            raise kind(f"{self.name}: {means}{'; then resume' if gone else ''}") from error


DRIVER = NiModule
