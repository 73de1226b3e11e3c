"""The board's firmware without its line: commands in, answers out, samples cut into blocks.

`docs/board-protocol.md` is what it obeys; the section numbers below are its own.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from hil_sim.board_preview import BoardPreview
from hil_sim.capture import Block, BlockCapture
from hil_sim.clock import DeviceClock, SampleClock
from protocols.board.limits import block_bytes, refusal, samples_per_frame
from protocols.board.messages import (
    decode_configuration,
    decode_release,
    decode_resend,
    dictionary_hash,
    encode_dictionary,
    encode_reply,
    encode_status,
    hello_fragments,
)
from protocols.board.records import (
    BlockInfo,
    BoardDictionary,
    BoardState,
    BoardStatus,
    Configuration,
    Frame,
    FrameType,
    Header,
    IepeState,
    Overflow,
    ReplyCode,
    Samples,
)
from protocols.errors import FrameError

__all__ = ["CONVERTER_HZ", "Answer", "BoardFirmware", "Converter", "Portion"]

CONVERTER_HZ = 51_200  # the converter makes this rate and its whole fractions
LARGEST_DIVISOR = 512
RESEND_QUEUE = 16

Answer = tuple[FrameType, bytes]
Counts = npt.NDArray[np.int32]


@dataclass(frozen=True, slots=True, kw_only=True)
class Converter:
    """How the firmware starts, stops and reads the converter."""

    start: Callable[[Fraction], None]
    stop: Callable[[], None]
    read: Callable[[int], Counts]


@dataclass(frozen=True, slots=True)
class Portion:
    """A range of a held block to be sent; with a count of 0 only BLOCK_READY."""

    block_id: int
    first: int
    count: int
    announce: bool


class BoardFirmware:
    """State of the board between two frames.

    Attributes
    ----------
    session, sequence, overflow
        As the header carries them.
    """

    def __init__(
        self,
        dictionary: BoardDictionary,
        *,
        session: int,
        clock: DeviceClock,
        converter: Converter,
    ) -> None:
        self._clock = clock
        self._converter = converter
        self.set_dictionary(dictionary)
        self.session = session
        self.sequence = 0
        self.overflow = Overflow.NONE
        self.state = BoardState.IDLE
        self._configuration: Configuration | None = None
        self._columns: list[int] = []
        self._capture: BlockCapture | None = None
        self._sampling: SampleClock | None = None
        self._held: dict[int, Block] = {}
        self._last_block = 0
        self._portions: deque[Portion] = deque()
        self._dropped = 0
        self._preview: BoardPreview | None = None
        self._overruns = 0

    def set_dictionary(self, dictionary: BoardDictionary) -> None:
        """Describe the board from now on; the hash in every frame follows."""
        self.dictionary = dictionary
        self.dictionary_bytes = encode_dictionary(dictionary)
        self.dictionary_hash = dictionary_hash(self.dictionary_bytes)

    def open_sensor(self, channel: int) -> None:
        """The supply of a channel's sensor has opened: the dictionary says so (section 5)."""
        channels = list(self.dictionary.channels)
        channels[channel] = replace(channels[channel], iepe=IepeState.OPEN)
        self.set_dictionary(replace(self.dictionary, channels=tuple(channels)))

    # Commands

    def handle(self, frame: Frame) -> list[Answer]:
        """Carry out a command and return what answers it."""
        kind = frame.header.type
        if kind >= FrameType.HELLO_REPLY:
            return []
        if kind is FrameType.HELLO:
            return [
                (FrameType.HELLO_REPLY, part) for part in hello_fragments(self.dictionary_bytes)
            ]
        reply_kind = FrameType(kind | 0x80)
        if frame.header.session != self.session:
            reason = f"board session 0x{self.session:08x}, command 0x{frame.header.session:08x}"
            return [(reply_kind, encode_reply(ReplyCode.WRONG_SESSION, reason))]
        if kind is FrameType.STATUS:
            return [(reply_kind, encode_status(self._status()))]
        try:
            code, reason = self._carry_out(kind, frame.payload)
        except FrameError as error:
            code, reason = ReplyCode.BAD_VALUE, str(error)
        return [(reply_kind, encode_reply(code, reason))]

    def _carry_out(self, kind: FrameType, payload: bytes) -> tuple[ReplyCode, str]:
        match kind:
            case FrameType.CONFIGURE:
                return self._configure(decode_configuration(payload))
            case FrameType.START:
                return self._start()
            case FrameType.STOP:
                return self._stop()
            case FrameType.RESEND:
                return self._resend(*decode_resend(payload))
            case FrameType.RELEASE:
                return self._release(decode_release(payload))
        return ReplyCode.UNKNOWN_COMMAND, f"type 0x{kind:02x}"

    def _configure(self, configuration: Configuration) -> tuple[ReplyCode, str]:
        if self.state is BoardState.RUNNING:
            return ReplyCode.WRONG_STATE, "RUNNING; STOP first"
        refused = _rate_refusal(configuration.rate_hz) or refusal(configuration, self.dictionary)
        if refused:
            return refused
        mask = configuration.channel_mask
        self._columns = [i for i in range(len(self.dictionary.channels)) if mask >> i & 1]
        self._configuration = configuration
        self._free_all()
        self.state = BoardState.CONFIGURED
        return ReplyCode.OK, ""

    def _start(self) -> tuple[ReplyCode, str]:
        configuration = self._configuration
        if configuration is None or self.state is not BoardState.CONFIGURED:
            return ReplyCode.WRONG_STATE, f"{self.state.name}; CONFIGURED wanted"
        self._free_all()
        self.overflow = Overflow.NONE
        self._overruns = 0
        if configuration.stream:
            self._preview = BoardPreview(
                rate_hz=configuration.rate_hz, n_channels=len(self._columns)
            )
        self._dropped = 0
        self._capture = BlockCapture(
            configuration,
            n_channels=len(self._columns),
            trigger_column=self._columns.index(configuration.trigger_channel),
        )
        self._converter.start(configuration.rate_hz)
        self._sampling = SampleClock(
            rate_hz=configuration.rate_hz,
            tick_hz=self._clock.tick_hz,
            start_ticks=self._clock.ticks(),
        )
        self.state = BoardState.RUNNING
        return ReplyCode.OK, ""

    def _stop(self) -> tuple[ReplyCode, str]:
        if self.state is BoardState.RUNNING:
            self._converter.stop()
            self._end_preview()
            self.state = BoardState.CONFIGURED
        return ReplyCode.OK, ""

    def _resend(self, block_id: int, first: int, count: int) -> tuple[ReplyCode, str]:
        block = self._held.get(block_id)
        if block is None:
            return ReplyCode.UNKNOWN_BLOCK, f"block {block_id} is not held"
        if first + count > len(block.counts):
            return ReplyCode.BAD_VALUE, (
                f"samples {first}...{first + count - 1} of a block of {len(block.counts)}"
            )
        if len(self._portions) >= RESEND_QUEUE:
            return ReplyCode.WRONG_STATE, f"the queue of {RESEND_QUEUE} ranges is full"
        self._portions.append(Portion(block_id, first, count, announce=True))
        return ReplyCode.OK, ""

    def _release(self, block_id: int) -> tuple[ReplyCode, str]:
        if not 1 <= block_id <= self._last_block:
            return ReplyCode.UNKNOWN_BLOCK, f"block {block_id} never was; last {self._last_block}"
        self._held.pop(block_id, None)
        self._portions = deque(p for p in self._portions if p.block_id != block_id)
        return ReplyCode.OK, ""

    def _free_all(self) -> None:
        self._held.clear()
        self._portions.clear()
        self._end_preview()

    def _end_preview(self) -> None:
        if self._preview is not None:
            self._dropped = self._preview.dropped
        self._preview = None

    def _status(self) -> BoardStatus:
        return BoardStatus(
            state=self.state,
            next_sequence=(self.sequence + 1) & 0xFFFF_FFFF,
            next_sample=self._capture.next_sample if self._capture else 0,
            buffered_blocks=len(self._held),
            oldest_block=min(self._held, default=0),
            stream_samples_dropped=self._dropped
            if self._preview is None
            else self._preview.dropped,
            triggers_missed=self._capture.missed if self._capture else 0,
            adc_overruns=self._overruns,
        )

    # Samples

    def samples_due(self) -> int:
        """How many samples are ready and not yet read."""
        if self.state is not BoardState.RUNNING or not self._sampling or not self._capture:
            return 0
        return max(0, self._sampling.due(self._clock.ticks()) - self._capture.next_sample)

    def take_samples(self, count: int) -> None:
        """Read samples from the converter into preview and blocks."""
        capture, configuration = self._capture, self._configuration
        if capture is None or configuration is None:
            return
        counts = self._converter.read(count)[:, self._columns]
        buffers = self.dictionary.block_capacity // block_bytes(configuration)
        if self._preview is not None:
            dropped = self._preview.dropped
            self._preview.add(capture.next_sample, counts)
            if self._preview.dropped > dropped:
                self.overflow |= Overflow.STREAM
        missed = capture.missed
        for block in capture.feed(counts, buffers - len(self._held)):
            self._last_block += 1
            self._held[self._last_block] = block
            whole = Portion(self._last_block, 0, len(block.counts), announce=True)
            self._portions.append(whole)
        if capture.missed > missed:
            self.overflow |= Overflow.BLOCK

    def lose_samples(self, count: int) -> None:
        """The converter loses samples: the index jumps (section 8)."""
        if self._capture is None or self.state is not BoardState.RUNNING:
            return
        self._converter.read(count)
        if self._preview is not None:
            self._preview.end_frame()
        missed = self._capture.missed
        self._capture.lose(count)
        self._overruns += 1
        self.overflow |= Overflow.ADC
        if self._capture.missed > missed:
            self.overflow |= Overflow.BLOCK

    # What goes out

    @property
    def has_data(self) -> bool:
        """Whether something waits for room on the link."""
        return bool(self._portions or self._preview)

    def next_data(self) -> BlockInfo | Samples | None:
        """What is to be sent next: announcements and blocks before the preview (section 10)."""
        while self._portions:
            portion = self._portions.popleft()
            block = self._held[portion.block_id]
            if portion.announce:
                if portion.count:
                    self._portions.appendleft(
                        Portion(portion.block_id, portion.first, portion.count, announce=False)
                    )
                return self._info(portion.block_id, block)
            taken = min(portion.count, samples_per_frame(block.counts.shape[1]))
            if taken < portion.count:
                rest = Portion(
                    portion.block_id, portion.first + taken, portion.count - taken, announce=False
                )
                self._portions.appendleft(rest)
            return Samples(
                first_sample=block.first_sample + portion.first,
                counts=block.counts[portion.first : portion.first + taken],
                block_id=portion.block_id,
            )
        return self._preview.next_frame() if self._preview is not None else None

    def _info(self, block_id: int, block: Block) -> BlockInfo:
        return BlockInfo(
            block_id=block_id,
            first_sample=block.first_sample,
            length=len(block.counts),
            trigger_sample=block.trigger_sample,
            trigger_ticks=self.ready_ticks(block.trigger_sample),
        )

    def ready_ticks(self, sample: int) -> int:
        """Ticks at which a sample of the last run was ready."""
        return self._sampling.ready_ticks(sample) if self._sampling else 0

    def header(
        self, kind: FrameType, *, tag: int = 0, first_sample: int = 0, ticks: int | None = None
    ) -> Header:
        """Compose the next header, which takes a sequence number."""
        sequence = self.sequence
        self.sequence = (sequence + 1) & 0xFFFF_FFFF
        return Header(
            type=kind,
            session=self.session,
            sequence=sequence,
            dictionary_hash=self.dictionary_hash,
            overflow=self.overflow,
            tag=tag,
            first_sample=first_sample,
            ticks=self._clock.ticks() if ticks is None else ticks,
        )


def _rate_refusal(rate_hz: Fraction) -> tuple[ReplyCode, str] | None:
    divisor = CONVERTER_HZ / rate_hz
    if divisor.denominator == 1 and 1 <= divisor <= LARGEST_DIVISOR:
        return None
    below = min(max(1, int(divisor)), LARGEST_DIVISOR)
    above = min(below + 1, LARGEST_DIVISOR)
    near = " and ".join(f"{CONVERTER_HZ}/{d}" for d in sorted({below, above}))
    return ReplyCode.BAD_VALUE, (
        f"rate {rate_hz} Hz cannot be made exactly: the nearest are {near} Hz"
    )
