"""In the place of the package sounddevice: a card that plays a sound file in a loop, in real time.

The file's name is in `ARMODAL_TEST_SOUND`; 24 bits, as `support.wav_file` writes them.
"""

import os
import threading
import time
import wave
from types import SimpleNamespace

import numpy as np

__version__ = "0.5"
EVERY_S = 0.01  # PortAudio's usual block


class PortAudioError(Exception):
    pass


def _samples():
    with wave.open(os.environ["ARMODAL_TEST_SOUND"], "rb") as file:
        n_channels = file.getnchannels()
        raw = np.frombuffer(file.readframes(file.getnframes()), np.uint8)
    three = raw.reshape(-1, n_channels, 3)
    four = np.zeros((*three.shape[:2], 4), np.uint8)
    four[:, :, 1:] = three  # the upper 24 of 32 bits
    return four.view("<i4")[:, :, 0]


def query_devices(device=None, kind=None):
    return {"name": "Line In", "max_input_channels": 4}


def check_input_settings(**given):
    """Every rate is made."""


class InputStream:
    def __init__(self, *, device, channels, dtype, samplerate, callback):
        self._rate_hz, self._callback = samplerate, callback
        self._samples = _samples()[:, :channels]
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._play, daemon=True)

    def start(self):
        self._thread.start()

    def close(self):
        self._ended.set()
        self._thread.join()

    def _play(self):
        began, at = time.monotonic(), 0
        while not self._ended.wait(EVERY_S):
            due = int((time.monotonic() - began) * self._rate_hz)
            block = np.take(self._samples, np.arange(at, due), axis=0, mode="wrap")
            told = SimpleNamespace(inputBufferAdcTime=at / self._rate_hz)
            self._callback(block, len(block), told, SimpleNamespace(input_overflow=False))
            at = due
