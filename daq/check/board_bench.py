"""What the steps of a board's check share: the probe, the dictionary, one long run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from armodal.daq.check.probe import PATIENCE_WALL_S, BoardProbe, BoardStepError
from armodal.daq.check.stream import Recording, record
from armodal.daq.check.tick_rate import tick_rate
from armodal.daq.clock import Clock
from armodal.daq.serial_port import BytePort
from armodal.protocols.board.limits import (
    refusal,
)
from armodal.protocols.board.messages import (
    decode_dictionary,
    decode_reply,
    encode_payload,
    join_hello,
)
from armodal.protocols.board.records import (
    BoardDictionary,
    Configuration,
    FrameType,
    ReplyCode,
    Slope,
)
from armodal.protocols.errors import DeviceTimeoutError, FrameError

__all__ = ["BoardBench", "BoardCheckOptions", "Hello", "hello"]

# Rates that converters are commonly asked for, highest first.
RATES_HZ = tuple(
    Fraction(rate)
    for rate in (
        102_400, 51_200, 48_000, 25_600, 24_000, 12_800, 10_240, 8_000, 6_400, 5_120, 4_096, 4_000,
        3_200, 2_560, 2_048, 2_000, Fraction(51_200, 31), 1_600, 1_280, 1_024, 1_000, 500,
    )
)  # fmt: skip
HELLO_TRIES = 3
HELLO_TIMEOUT_S = 0.5
PROBE_BLOCK = 64
LONG_ENOUGH_S = 60.0  # lab; round trips of 30 ms tell a clock to 500 ppm within it


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardCheckOptions:
    """How thoroughly to check.

    `duration_s` is of the long run, in lab seconds; one shorter than a minute goes on for a minute
    at most while it does not tell the rate of the board's clock. `rate_hz` None takes the highest
    rate the board accepts with its preview on. `patience_wall_s` is the least wait for an answer,
    seconds of this computer.
    """

    duration_s: float = LONG_ENOUGH_S
    rate_hz: Fraction | None = None
    seed: int = 1
    patience_wall_s: float = PATIENCE_WALL_S


@dataclass(frozen=True, slots=True, kw_only=True)
class Hello:
    """What a HELLO brought."""

    session: int
    header_hash: int
    data: bytes


def hello(probe: BoardProbe) -> Hello | None:
    """Ask for the dictionary; None if no whole one comes.

    Raises
    ------
    FrameError
        If its fragments contradict each other.
    """
    for _ in range(HELLO_TRIES):
        seen = len(probe.frames)
        tag = probe.send(FrameType.HELLO)
        found: list[Hello] = []

        def whole(seen: int = seen, tag: int = tag, found: list[Hello] = found) -> bool:
            parts = [
                f for f in probe.frames[seen:] if f.type == FrameType.HELLO_REPLY and f.tag == tag
            ]
            data = join_hello([f.payload for f in parts]) if parts else None
            if data is not None:
                last = parts[-1]
                found.append(
                    Hello(session=last.session, header_hash=last.dictionary_hash, data=data)
                )
            return bool(found)

        if probe.collect(probe.patience_s(HELLO_TIMEOUT_S), whole):
            return found[0]
    return None


class BoardBench:
    """A board on the bench.

    Attributes
    ----------
    probe : BoardProbe
        The line to it, exchanged by `reopen`.
    first : Hello
        What the first HELLO brought.
    accepted : list of Fraction
        Rates it accepted with the preview on, highest first; filled by the step `rates`.
    """

    def __init__(
        self, open_port: Callable[[], BytePort], clock: Clock, options: BoardCheckOptions
    ) -> None:
        self._open_port = open_port
        self.clock = clock
        self.options = options
        self.probe = self._new_probe()
        self.accepted: list[Fraction] = []
        self._recording: Recording | None = None
        try:
            self.first = self._meet()
        except BaseException:
            self.close()
            raise
        self.probe.session = self.first.session
        self._dictionary: BoardDictionary | None = None

    def _new_probe(self) -> BoardProbe:
        patience_wall_s = self.options.patience_wall_s
        return BoardProbe(self._open_port(), self.clock, patience_wall_s=patience_wall_s)

    def _meet(self) -> Hello:
        found = hello(self.probe)
        if found is not None:
            return found
        name, n_bytes = self.probe.port.name, self.probe.received_bytes
        if n_bytes == 0:
            raise DeviceTimeoutError(
                f"the device on {name} did not answer HELLO in {HELLO_TRIES} tries; is the board "
                "switched on, is this its port, and is the baud rate right?"
            )
        detail = f" Last fault: {self.probe.faults[-1]}." if self.probe.faults else ""
        raise FrameError(
            f"the device on {name} sent {n_bytes} bytes but no whole HELLO_REPLY of the armodal "
            f"board protocol.{detail} Is it the right port, and the baud rate right?"
        )

    @property
    def dictionary(self) -> BoardDictionary:
        """The board's dictionary; FrameError if it cannot be read."""
        if self._dictionary is None:
            self._dictionary = decode_dictionary(self.first.data)
        return self._dictionary

    @property
    def all_channels(self) -> int:
        """Mask of all channels."""
        return (1 << len(self.dictionary.channels)) - 1

    def configuration(self, rate_hz: Fraction, **changes: Any) -> Configuration:
        """Return a modest configuration with the preview on, never triggered by itself."""
        modest = Configuration(
            rate_hz=rate_hz,
            channel_mask=self.all_channels,
            trigger_channel=0,
            trigger_level_counts=(1 << 23) - 1,
            slope=Slope.RISING,
            pretrigger=0,
            block_length=PROBE_BLOCK,
            stream=True,
        )
        return replace(modest, **changes)

    def configure(self, configuration: Configuration) -> tuple[ReplyCode, str]:
        """Try a configuration; return the board's code and reason."""
        payload = encode_payload(configuration)
        return decode_reply(self.probe.ask(FrameType.CONFIGURE, payload).payload)

    def find_rates(self) -> list[Fraction]:
        """Return the rates that the board takes with its preview on, highest first."""
        if not self.accepted:
            wanted = {*RATES_HZ, *([self.options.rate_hz] if self.options.rate_hz else [])}
            for rate_hz in sorted(wanted, reverse=True):
                configuration = self.configuration(rate_hz)
                if refusal(configuration, self.dictionary) is None:
                    code, _ = self.configure(configuration)
                    if code is ReplyCode.OK:
                        self.accepted.append(rate_hz)
        return self.accepted

    @property
    def rate_hz(self) -> Fraction:
        """Rate of the runs; BoardStepError if the board takes none."""
        accepted = self.find_rates()
        wanted = self.options.rate_hz
        if wanted is not None and wanted not in accepted:
            raise BoardStepError(f"the board does not take the rate asked for, {wanted} Hz")
        if not accepted:
            raise BoardStepError("the board takes none of the usual rates; name one with --rate")
        return wanted or accepted[0]

    def recording(self) -> Recording:
        """Return the long run, made when first asked for."""
        if self._recording is None:
            configuration = self.configuration(self.rate_hz)
            taken = self._record(configuration)
            if taken.statuses[-1][0].stream_samples_dropped:
                # The preview is best effort: this computer may have been busy. Once more.
                taken = self._record(configuration)
            self._recording = taken
        return self._recording

    def _record(self, configuration: Configuration) -> Recording:
        tick_hz = self.dictionary.tick_hz
        return record(
            self.probe,
            configuration,
            self.options.duration_s,
            most_s=LONG_ENOUGH_S,
            enough=lambda trips: tick_rate(trips, nominal_tick_hz=tick_hz).told,
        )

    def reopen(self) -> None:
        """Close the port and open it again, as another host program would."""
        session = self.probe.session
        self.probe.port.close()
        self.probe = self._new_probe()
        self.probe.session = session

    def meet_again(self) -> Hello | None:
        """Take the board up by the session it has now; None if it does not answer."""
        found = hello(self.probe)
        if found is not None:
            self.probe.session = found.session
        return found

    def close(self) -> None:
        """Let go of the port."""
        self.probe.port.close()
