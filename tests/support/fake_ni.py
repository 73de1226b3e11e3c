"""The package nidaqmx as far as it is used, with a module in the test's hand.

Names, arguments and codes are those of nidaqmx 1.7 and NI-DAQmx.
"""

from enum import Enum, auto
from types import SimpleNamespace

import numpy as np


class Error(Exception):
    pass


class DaqNotFoundError(Error):
    pass


class RpcError(Error):
    pass


class DaqError(Error):
    def __init__(self, message, error_code, task_name=""):
        super().__init__(message)
        self.error_code = error_code


def _enum(name, *members):
    return Enum(name, [(member, auto()) for member in members])


class FakeNi:
    """`modules` go into sys.modules. Volts wait in `volts`, (n, n_channels); `fails` is a code that
    the next call of a kind raises."""

    def __init__(self) -> None:
        self.volts = np.zeros((0, 2))
        self.channels, self.rate_hz, self.running = [], 0.0, False
        self.open_inputs, self.looks_for_open = [], True
        self.short_inputs = []
        self.teds = {}  # place: bytes in a list, as the package gives them
        self.installed, self.fails, self.closed = True, {}, False
        constants = SimpleNamespace(
            AcquisitionType=_enum("AcquisitionType", "FINITE", "CONTINUOUS"),
            ExcitationSource=_enum("ExcitationSource", "INTERNAL", "EXTERNAL", "NONE"),
            ForceUnits=_enum("ForceUnits", "NEWTONS"),
            AccelUnits=_enum("AccelUnits", "METERS_PER_SECOND_SQUARED"),
            ForceIEPESensorSensitivityUnits=_enum("Force", "MILLIVOLTS_PER_NEWTON"),
            AccelSensitivityUnits=_enum("Accel", "MILLIVOLTS_PER_G"),
        )
        errors = SimpleNamespace(
            Error=Error, DaqError=DaqError, DaqNotFoundError=DaqNotFoundError, RpcError=RpcError
        )
        device = SimpleNamespace(name="cDAQ1Mod1", product_type="NI 9234")
        system = SimpleNamespace(System=SimpleNamespace(local=lambda: self._system(device)))
        self.modules = {
            "nidaqmx": SimpleNamespace(
                __version__="1.7.0", Task=self._task, errors=errors, system=system
            ),
            "nidaqmx.constants": constants,
            "nidaqmx.system.physical_channel": SimpleNamespace(
                PhysicalChannel=self._physical_channel
            ),
            "nidaqmx.stream_readers": SimpleNamespace(AnalogMultiChannelReader=self._reader),
        }

    def _physical_channel(self, place, grpc_options=None):
        def configure_teds():
            if place not in self.teds:
                raise DaqError("no TEDS", -200741)

        return SimpleNamespace(configure_teds=configure_teds, teds_bit_stream=self.teds.get(place))

    def _system(self, device):
        if not self.installed:
            raise DaqNotFoundError("Could not find an installation of NI-DAQmx")
        return SimpleNamespace(devices=[device])

    def _may_fail(self, call):
        if call in self.fails:
            raise DaqError(f"NI says something about {call}", self.fails[call])

    def _task(self):
        if not self.installed:
            raise DaqNotFoundError("Could not find an installation of NI-DAQmx")
        fake = self

        class Stream:
            @property
            def avail_samp_per_chan(self):
                fake._may_fail("read")
                return len(fake.volts)

            @property
            def open_current_loop_chans_exist(self):
                if not fake.looks_for_open:
                    raise DaqError("not supported", -200452)
                return bool(fake.open_inputs)

            @property
            def open_current_loop_chans(self):
                return fake.open_inputs

            @property
            def excit_fault_chans_exist(self):
                return bool(fake.short_inputs)

            @property
            def excit_fault_chans(self):
                return fake.short_inputs

        class Timing:
            def cfg_samp_clk_timing(self, rate, *, sample_mode, samps_per_chan):
                fake._may_fail("rate")
                # An NI 9234 makes 51200 Hz over 1 to 31, and takes the next higher rate.
                fake.rate_hz = 51_200 / max(min(int(51_200 / rate * (1 + 1e-12)), 31), 1)

            @property
            def samp_clk_rate(self):
                return fake.rate_hz

        def add(place, **given):
            fake._may_fail("add")
            fake.channels.append((place, given))

        return SimpleNamespace(
            in_stream=Stream(),
            timing=Timing(),
            ai_channels=SimpleNamespace(add_ai_force_iepe_chan=add, add_ai_accel_chan=add),
            start=self._start,
            stop=lambda: setattr(self, "running", False),
            close=lambda: setattr(self, "closed", True),
        )

    def _start(self):
        self._may_fail("start")
        self.running = True

    def _reader(self, _stream):
        def read_many_sample(data, number_of_samples_per_channel, *, timeout):
            n = number_of_samples_per_channel
            for row, (_, given) in zip(data, self.channels, strict=True):
                i = [place for place, _ in self.channels].index(_)
                row[:] = self._physical(self.volts[:n, i], given)
            self.volts = self.volts[n:]

        return SimpleNamespace(read_many_sample=read_many_sample)

    @staticmethod
    def _physical(volts, given):
        """N, or m/s^2 of mV/g, as the driver scales."""
        per_unit = given["sensitivity"]
        if given["sensitivity_units"].name == "MILLIVOLTS_PER_G":
            per_unit /= 9.80665
        return 1e3 * volts / per_unit
