"""The package sounddevice as far as it is used, with a card in the test's hand."""

from types import SimpleNamespace

import numpy as np


class PortAudioError(Exception):
    pass


class FakeSound:
    """Put `module` in the place of sounddevice; `bring` makes the card deliver a block."""

    def __init__(self, *, inputs=4, rates=(44_100, 48_000)) -> None:
        self.inputs, self.rates, self.busy = inputs, rates, False
        self.stream = None
        self.adc_s = 7.0  # the card's own time
        self.module = SimpleNamespace(
            __version__="0.5",
            PortAudioError=PortAudioError,
            query_devices=self._query,
            check_input_settings=self._check,
            InputStream=self._open,
        )

    def bring(self, counts, *, lost=0):
        """A block of 24-bit counts, after samples that the card has lost."""
        rate_hz = self.stream["samplerate"]
        self.adc_s += lost / rate_hz
        time = SimpleNamespace(inputBufferAdcTime=self.adc_s)
        status = SimpleNamespace(input_overflow=bool(lost))
        samples = np.asarray(counts, dtype=np.int32) << 8
        self.stream["callback"](samples, len(samples), time, status)
        self.adc_s += len(samples) / rate_hz

    def _query(self, device=None, kind=None):
        card = {"name": "Line In", "max_input_channels": self.inputs}
        if device is None and kind is None:
            return [card, {"name": "Speaker", "max_input_channels": 0}]
        if device not in (None, 0, "Line In"):
            raise ValueError("No input device matching")
        return card

    def _check(self, *, device, channels, dtype, samplerate):
        if samplerate not in self.rates:
            raise PortAudioError("Invalid sample rate [PaErrorCode -9997]")

    def _open(self, **given):
        if self.busy:
            raise PortAudioError("Device unavailable [PaErrorCode -9985]")
        self.stream = given
        return SimpleNamespace(start=lambda: None, close=lambda: None)
