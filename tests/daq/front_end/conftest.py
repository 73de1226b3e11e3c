from fractions import Fraction

import pytest

from armodal.daq.board_link import BoardLink
from armodal.protocols.board.messages import decode_samples
from armodal.protocols.board.records import Configuration, FrameType, Slope


class Time:
    """A clock in the test's hand."""

    def __init__(self):
        self.now = 1000.0

    def now_s(self):
        return self.now

    def sleep(self, lab_s):
        self.now += lab_s

    def wall_s(self, lab_s):
        return lab_s

    def wait(self, descriptors, wall_s):
        return list(descriptors)


@pytest.fixture
def time():
    return Time()


@pytest.fixture
def run_link(time):
    """Start a port's board by the link that an acquisition uses; return link and dictionary."""

    def start(port, rate_hz, *, level=None, pretrigger=0, length=64):
        link = BoardLink(port, time)
        found = link.hello()
        link.configure(
            Configuration(
                rate_hz=Fraction(rate_hz),
                channel_mask=(1 << len(found.dictionary.channels)) - 1,
                trigger_channel=0,
                trigger_level_counts=2**22 if level is None else level,
                slope=Slope.RISING,
                pretrigger=pretrigger,
                block_length=length,
                stream=True,
            )
        )
        link.start()
        return link, found

    return start


@pytest.fixture
def streamed():
    """Return the samples of the preview that a link has, with their first indices."""

    def of(link):
        frames = [f for f in link.pump() if f.header.type is FrameType.STREAM]
        return [(f.header, decode_samples(f)) for f in frames]

    return of
