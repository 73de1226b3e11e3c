"""A running board: its frames sorted, its clock followed, its blocks fetched and released."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

from armodal.daq.blocks import BlockCollector, CapturedBlock
from armodal.daq.board_link import BoardLink, FoundBoard
from armodal.daq.clock import Clock
from armodal.daq.clock_fit import ClockFit, ClockTracker
from armodal.daq.judge import FORCE, channels_of
from armodal.daq.losses import LossTally
from armodal.daq.preview import StreamWatch
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.board.messages import (
    decode_answer,
    decode_payload,
    decode_reply,
    decode_samples,
    encode_payload,
)
from armodal.protocols.board.records import (
    MESSAGES,
    BlockInfo,
    BoardStatus,
    Channel,
    Configuration,
    Frame,
    FrameType,
    Release,
    ReplyCode,
    Resend,
    Slope,
)
from armodal.protocols.board.samples import (
    COUNT_MAX,
)
from armodal.protocols.errors import BoardRefusedError, DeviceLostError, FrameError, PlanError
from armodal.protocols.plan_records import Plan

__all__ = ["BoardSession", "configuration_for", "measured_mask"]

FIRST_ROUND_TRIPS = 20
STATUS_EVERY_S = 0.5  # lab seconds
STATUS_EVERY_WALL_S = 0.03
RESEND_AFTER_S = 0.2  # lab seconds
RESEND_AFTER_WALL_S = 0.05
RELEASE_AGAIN_WALL_S = 0.5

_REPLIES = frozenset(
    {FrameType.STATUS_REPLY, FrameType.RESEND_REPLY, FrameType.RELEASE_REPLY, FrameType.STOP_REPLY}
)


def measured_mask(channels: tuple[Channel, ...]) -> int:
    """Return the mask of the channels that measure force or acceleration.

    Raises
    ------
    BoardRefusedError
        If the board has no force channel, or nothing to measure the response.
    """
    mask = sum(1 << i for i, c in enumerate(channels) if c.quantity in {FORCE, "acceleration"})
    quantities = {c.quantity for i, c in enumerate(channels) if mask >> i & 1}
    if quantities != {FORCE, "acceleration"}:
        raise BoardRefusedError(
            "wanted a board with a force and an acceleration channel, this one has: "
            + (", ".join(f"{c.name} ({c.quantity})" for c in channels) or "none")
        )
    return mask


def configuration_for(
    plan: Plan, channels: tuple[Channel, ...], mask: int, *, stream: bool
) -> Configuration:
    """Return what a plan asks of a board with these channels.

    Raises
    ------
    PlanError
        If the trigger level is beyond the force channel's range.
    """
    index = next(i for i, c in enumerate(channels) if c.quantity == FORCE)
    # A hammer that reads a push as negative crosses the level downwards, below zero.
    sign = 1.0 if plan.trigger.rising else -1.0
    level = round(sign * abs(plan.trigger.level_n) / channels[index].scale)
    if abs(level) > COUNT_MAX:
        raise PlanError(
            f"trigger level {plan.trigger.level_n:g} N is beyond the range of "
            f"{channels[index].name}, {COUNT_MAX * abs(channels[index].scale):.4g} N"
        )
    # A channel that inverts crosses the level the other way in counts.
    rising = plan.trigger.rising == (channels[index].scale > 0.0)
    return Configuration(
        rate_hz=plan.sampling.rate_hz,
        channel_mask=mask,
        trigger_channel=index,
        trigger_level_counts=level,
        slope=Slope.RISING if rising else Slope.FALLING,
        pretrigger=plan.sampling.pretrigger,
        block_length=plan.sampling.samples,
        stream=stream,
    )


class BoardSession:
    """One board from HELLO to STOP.

    Parameters
    ----------
    link
        The conversation with it.
    found
        What HELLO returned.
    settings
        Of the acquisition.
    clock
        The laboratory's.
    losses
        Where everything that did not arrive is noted.
    """

    def __init__(
        self,
        link: BoardLink,
        found: FoundBoard,
        settings: AcquisitionSettings,
        clock: Clock,
        losses: LossTally,
    ) -> None:
        self._link = link
        self._clock = clock
        self._losses = losses
        self.found = found
        self.mask = measured_mask(found.dictionary.channels)
        self.channels = channels_of(found.dictionary, self.mask)
        self._configuration = configuration_for(
            settings.plan, found.dictionary.channels, self.mask, stream=settings.stream
        )
        n_channels = len(self.channels)
        self._resend_after_s = max(
            RESEND_AFTER_S, RESEND_AFTER_WALL_S / max(clock.wall_s(1.0), 1e-9)
        )
        self._blocks = BlockCollector(
            n_channels,
            block_length=settings.plan.sampling.samples,
            resend_after_s=self._resend_after_s,
            max_blocks=settings.blocks_in_memory(n_channels),
        )
        self.stream = StreamWatch(n_channels)
        self._tracker = ClockTracker(found.dictionary.tick_hz)
        self._jumped_sample = 0
        self._status_at_s = 0.0
        self._releasing: dict[int, float] = {}  # block: wall-scaled time of the last RELEASE
        self._release_tags: deque[tuple[int, int]] = deque(maxlen=64)
        self._malformed = 0
        self.status: BoardStatus | None = None
        self.notes: tuple[str, ...] = ()  # what the board told beside its status

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._link.fileno()

    @property
    def clock_fit(self) -> ClockFit:
        """Host time of the board's ticks."""
        return self._tracker.fit()

    def clock_known(self, block: CapturedBlock) -> bool | None:
        """Whether a block's ticks are of the clock that is followed; None while unknown.

        They are not where the block began before a jump was noticed, and it is not known before
        a round trip that began after the block was announced.
        """
        if block.info.first_sample < self._jumped_sample:
            return False
        return True if block.announced_s <= self._tracker.seen_s else None

    @property
    def clock_jumped_s(self) -> float:
        """Host time when the board's clock was last found to have jumped."""
        return self._tracker.jumped_s

    @property
    def waits_for_reply(self) -> bool:
        """Whether a reply is due, and a prompt reader makes the clock fit better."""
        return self._link.waits_for_reply()

    def prepare(self) -> None:
        """Configure the board, learn its clock, and ask what the session is to note of it."""
        self._link.stop()
        self._link.configure(self._configuration)
        for _ in range(FIRST_ROUND_TRIPS):
            self.status, trip = self._link.status()
            self._tracker.add(trip)
        self.notes = tuple(self._told())

    def _told(self) -> Iterator[str]:
        """Ask for each message that is to be noted; a board that refuses it has none to tell."""
        for kind, message in MESSAGES.items():
            if message.note is None or message.record is None:
                continue
            try:
                reply = self._link.request(FrameType(kind & 0x7F))
                told: object = decode_answer(message.record, reply.frame.payload)
            except BoardRefusedError:
                continue
            except FrameError as error:
                yield f"the board's {kind.name} cannot be read: {error}"
                continue
            yield message.note(told)

    def start(self) -> None:
        """Let it run."""
        self._link.start()
        self.status = None  # its counters begin anew
        self._status_at_s = self._clock.now_s()

    def turn(self, now_s: float, *, readable: bool) -> None:
        """Take in what has come, if anything has, and ask for what is missing; never waits."""
        for frame in self._link.pump() if readable else ():
            self._take_or_count(frame, now_s)
        for wanted in self._blocks.overdue(now_s):
            self._link.send(
                FrameType.RESEND,
                encode_payload(
                    Resend(block_id=wanted.block_id, first=wanted.first, count=wanted.count)
                ),
            )
        self._release_again(now_s)
        status_every_s = max(STATUS_EVERY_S, STATUS_EVERY_WALL_S / self._clock.wall_s(1.0))
        if now_s - self._status_at_s >= status_every_s:
            self._status_at_s = now_s
            self._link.send(FrameType.STATUS)
        self._link.check_alive()

    @property
    def blocks_under_way(self) -> int:
        """Blocks that have been announced and are not whole yet."""
        return len(self._blocks)

    @property
    def health_of_clock(self) -> tuple[float, float]:
        """Standard uncertainty of host time at the last reading in s, rate of the clock in ppm."""
        fit, nominal_hz = self._tracker.fit(), self.found.dictionary.tick_hz
        rate_ppm = 1e6 * (1.0 / (fit.s_per_tick * nominal_hz) - 1.0)
        return fit.uncertainty_s(fit.reference_ticks), rate_ppm

    def captured(self, now_s: float) -> CapturedBlock | None:
        """Return the next block that is whole, or as whole as it will get."""
        return self._blocks.take(now_s)

    def release(self, block_id: int, now_s: float) -> None:
        """Let the board forget a block; asked again until the board confirms."""
        self._releasing[block_id] = now_s
        self._release_tags.append(
            (
                self._link.send(FrameType.RELEASE, encode_payload(Release(block_id=block_id))),
                block_id,
            )
        )

    def count_losses(self, now_s: float) -> None:
        """Note what has been lost since the last time."""
        watch = self._losses.watch
        stream = self.stream
        watch("stream", stream.missing, "preview samples that never came", now_s, stream.last_gap)
        watch("frame", self._link.frames_lost, "frames missing by their number", now_s)
        watch("frame", self._link.bad_frames, "stretches that were no valid frame", now_s)
        watch("frame", self._malformed + stream.malformed, "frames with a malformed payload", now_s)
        if self.status is not None:
            watch("trigger", self.status.triggers_missed, "triggers the board missed", now_s)
            watch("stream", self.status.adc_overruns, "overruns of the converter", now_s)

    def stop(self) -> BoardStatus:
        """Stop sampling, take in what was on the way, and return the last counts."""
        self._link.stop()
        status, _ = self._link.status()
        self.status = status
        now_s = self._clock.now_s()
        for frame in self._link.pump():
            self._take_or_count(frame, now_s)
        # What the board dropped behind the last frame that came shows in no gap.
        unseen = min(status.next_sample - self.stream.expected, status.stream_samples_dropped)
        self._losses.add("stream", unseen, "preview samples dropped at the end", now_s)
        return status

    def _take_or_count(self, frame: Frame, now_s: float) -> None:
        try:
            self._take(frame, now_s)
        except FrameError:
            self._malformed += 1

    def _take(self, frame: Frame, now_s: float) -> None:
        kind = frame.header.type
        if kind is FrameType.STREAM:
            self.stream.add(frame)
        elif kind is FrameType.BLOCK_DATA:
            self._blocks.add(decode_samples(frame), now_s)
        elif kind is FrameType.BLOCK_READY:
            if self._blocks.announce(decode_payload(BlockInfo, frame.payload), now_s):
                # The reply shows whether the clock is still what it was.
                self._link.send(FrameType.STATUS)
        elif kind in _REPLIES:
            reply = self._link.reply_of(frame)
            if kind is FrameType.STATUS_REPLY:
                status = decode_answer(BoardStatus, frame.payload)
                self._take_status(status)
                if reply is not None and self._tracker.add(reply.trip):
                    self._jumped_sample = status.next_sample
            elif kind is FrameType.RELEASE_REPLY:
                self._confirm_release(frame)

    def _take_status(self, status: BoardStatus) -> None:
        self.status = status
        oldest = status.oldest_block
        if status.buffered_blocks and not self._blocks.knows(oldest):
            self._link.send(
                FrameType.RESEND, encode_payload(Resend(block_id=oldest, first=0, count=0))
            )

    def _confirm_release(self, frame: Frame) -> None:
        code, reason = decode_reply(frame.payload)
        if code is ReplyCode.WRONG_SESSION:
            raise DeviceLostError(
                f"the board has restarted ({reason or code.name}): its blocks are gone; resume "
                "the session"
            )
        for tag, block_id in self._release_tags:
            if tag == frame.header.tag:
                self._releasing.pop(block_id, None)

    def _release_again(self, now_s: float) -> None:
        again_s = RELEASE_AGAIN_WALL_S / self._clock.wall_s(1.0)
        for block_id, asked_s in tuple(self._releasing.items()):
            if now_s - asked_s > again_s:
                self.release(block_id, now_s)
