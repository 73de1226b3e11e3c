"""Any device of openDAQ, by the package opendaq: samples with the device's own time beside them.

The domain of a signal counts in ticks, a fixed number of them a sample: gaps are what is missing
between them.
"""

from __future__ import annotations

import importlib
import itertools
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.daq.front_end.source import Chunk, to_counts
from armodal.daq.front_end.timing import SampleTimes
from armodal.protocols.errors import DeviceLostError, FrontEndError, MissingPackageError
from armodal.protocols.front_end import FrontEnd

__all__ = ["DRIVER", "OpenDaqDevice", "opendaq_package"]

RATE_PROPERTIES = ("GlobalSampleRate", "SampleRate")  # as openDAQ's devices call it
_UNITS = {"N": ("N",), "m/s^2": ("m/s^2", "m/s²")}
_NAMED = 12  # signals in a message


def opendaq_package() -> Any:
    """Return the package opendaq, or raise MissingPackageError saying how to get it."""
    try:
        return importlib.import_module("opendaq")
    except ImportError as error:
        raise MissingPackageError(
            "wanted the package opendaq for a device of openDAQ, it is not installed, or not made "
            "for this system; install it with `pip install 'armodal[opendaq]'`"
        ) from error


class OpenDaqDevice:
    """Signals of one device, read together.

    Raises
    ------
    MissingPackageError, FrontEndError
        If the package, the device or a signal is not there, or a signal is of another kind.
    """

    teds: tuple[bytes, ...] = ()

    def __init__(self, front_end: FrontEnd) -> None:
        self._daq = opendaq_package()
        self.name = front_end.source
        self.driver = "opendaq"
        self._instance = self._daq.Instance()
        try:
            self._device = self._instance.add_device(front_end.source)
        except RuntimeError as error:
            there = ", ".join(d.connection_string for d in self._instance.available_devices)
            raise FrontEndError(
                f"front-end file {front_end.name}: source: no device of openDAQ answers at "
                f"{front_end.source!r}; found are: {there or 'none'}"
            ) from error
        self._signals = [self._signal(str(name)) for name in front_end.inputs]
        self._per_full_scale = np.array(
            [self._part_of_range(front_end, i) for i in range(len(self._signals))]
        )
        self._reader: Any = None
        self._times: SampleTimes | None = None
        self._next_tick: int | None = None
        self._delta = 1

    def rate_refusal(self, rate_hz: Fraction) -> str:
        """Ask the device for the rate; return which it makes in place of it."""
        for owner in (self._device, *self._device.channels_recursive):
            for name in RATE_PROPERTIES:
                if owner.has_property(name):
                    self._set(owner, name, float(rate_hz))
        made_hz = {self._made_hz(signal) for signal in self._signals}
        if made_hz == {rate_hz}:
            return ""
        made = " and ".join(f"{float(made):.9g}" for made in sorted(made_hz))
        return f"{self.name} makes {made} Hz instead"

    def start(self, rate_hz: Fraction, now_s: float) -> None:
        """Begin to read."""
        rule = self._signals[0].domain_signal.descriptor.rule
        self._delta = int(dict(rule.parameters)["delta"])
        self._times = SampleTimes(self.name, float(rate_hz), now_s)
        self._next_tick = None
        self._reader = self._daq.MultiReader(self._signals)

    def stop(self) -> None:
        """Read no more."""
        self._reader = None

    def read(self, now_s: float) -> list[Chunk]:
        """Return the samples that wait."""
        times = self._times
        if self._reader is None or times is None:
            return []
        # Where no sample waits an event may, and only a reading takes it away.
        n = max(int(self._reader.available_count), 1)
        values, domain = self._reader.read_with_domain(n, 0)[:2]
        values, ticks = np.atleast_2d(np.asarray(values)), np.atleast_2d(np.asarray(domain))
        if not ticks.size:
            times.check(now_s)
            return []
        counts = to_counts(values.T * self._per_full_scale)
        return self._chunks(counts, ticks[0].astype(np.int64), times, now_s)

    def close(self) -> None:
        """Let go of the device."""
        self._reader = None
        self._signals = []
        self._device = self._instance = None

    def _chunks(
        self,
        counts: npt.NDArray[np.int32],
        ticks: npt.NDArray[np.int64],
        times: SampleTimes,
        now_s: float,
    ) -> list[Chunk]:
        """Part samples where the device's ticks leave some out."""
        before = (
            ticks[0] - self._delta if self._next_tick is None else self._next_tick - self._delta
        )
        steps = np.diff(ticks, prepend=before)
        missing, rest = np.divmod(steps - self._delta, self._delta)
        if (missing < 0).any() or rest.any():
            raise DeviceLostError(
                f"the time of {self.name} jumps by other than whole samples: it was set anew; "
                "resume the session"
            )
        self._next_tick = int(ticks[-1]) + self._delta
        begins = np.flatnonzero(missing)
        edges = [0, *(int(i) for i in begins if i > 0), len(ticks)]
        chunks = []
        for first, end in itertools.pairwise(edges):
            lost = int(missing[first])
            times.lost(lost)
            ready_s = times.add(end - first, now_s)
            chunks.append(Chunk(counts=counts[first:end], ready_s=ready_s, lost=lost))
        return chunks

    def _signal(self, name: str) -> Any:
        signals = [s for s in self._device.signals_recursive if s.domain_signal is not None]
        found = [s for s in signals if name in {s.name, s.local_id, s.global_id}]
        if len(found) == 1:
            return found[0]
        names = ", ".join(s.name for s in signals[:_NAMED])
        raise FrontEndError(
            f"{self.name} has {len(found) or 'no'} signal{'s' * (len(found) > 1)} {name!r}, wanted "
            f"one; it has {names or 'none'}"
        )

    def _part_of_range(self, front_end: FrontEnd, i: int) -> float:
        """Return by what a value is multiplied to be 1 at full scale."""
        channel, signal = front_end.channels[i], self._signals[i]
        unit = signal.descriptor.unit
        symbol = "" if unit is None else str(unit.symbol)
        if front_end.sensitivity_mv[i] is not None:
            if symbol != "V" or front_end.range_v is None:
                raise FrontEndError(
                    f"{self.name}: signal {signal.name} is in {symbol or 'no unit'}: "
                    "sensitivity_mv is for V; give full_scale for what is scaled already"
                )
            return 1.0 / front_end.range_v
        if symbol not in _UNITS[channel.unit]:
            raise FrontEndError(
                f"{self.name}: signal {signal.name} is in {symbol or 'no unit'}: wanted "
                f"{channel.unit} with full_scale, or V with sensitivity_mv and range_v"
            )
        return float(np.sign(channel.scale)) / channel.full_scale

    def _set(self, owner: Any, name: str, rate_hz: float) -> None:
        try:
            owner.set_property_value(name, rate_hz)
        except (RuntimeError, TypeError):
            return  # it is read only, or of another kind: what is made is looked at next

    def _made_hz(self, signal: Any) -> Fraction:
        descriptor = signal.domain_signal.descriptor
        parameters = dict(descriptor.rule.parameters) if descriptor.rule is not None else {}
        if "delta" not in parameters:
            raise FrontEndError(
                f"{self.name}: signal {signal.name} has no even sample clock: wanted one with a "
                "linear rule"
            )
        resolution = descriptor.tick_resolution
        tick_s = Fraction(int(resolution.numerator), int(resolution.denominator))
        return 1 / (tick_s * int(parameters["delta"]))


DRIVER = OpenDaqDevice
