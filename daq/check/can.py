"""Check of a controller's bus against the arm file, step by step; nothing is sent to the bus."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from armodal.daq.can_listener import check_hears, open_can
from armodal.daq.check.can_bench import CanRecording, listen, mapping_of
from armodal.daq.check.can_values import (
    check_drive_state,
    check_resolution,
    check_scale,
    check_still,
)
from armodal.daq.check.run import choose, run_steps
from armodal.daq.check.verdict import Finding, Report, Step, StepResult, failed, passed, unchecked
from armodal.daq.clock import Clock, SystemClock
from armodal.protocols.arm.records import Arm

__all__ = ["CAN_STEPS", "check_can"]

# Status flags of slcan adapters (Lawicel, command F).
QUEUE_FULL, WARNING, OVERRUN, PASSIVE, BUS_ERROR = 0x01, 0x04, 0x08, 0x20, 0x80
FLAG_NAMES = {
    QUEUE_FULL: "receive queue full",
    WARNING: "error warning",
    OVERRUN: "data overrun",
    PASSIVE: "error passive",
    BUS_ERROR: "bus error",
}
LONGEST_ROW = 5  # of one frame; a counter makes each frame another one
RATE_TOLERANCE = 0.02
LONG_GAP_CYCLES = 3.0
LONG_GAP_SHARE = 0.1  # of the time listened
FEW_GAPS = 2  # long gaps that a busy host may cause
LATENCY_WALL_S = 0.02  # what an unhurried host may be late


def _flags(flags: int) -> str:
    return ", ".join(name for bit, name in FLAG_NAMES.items() if flags & bit)


def check_listening(heard: CanRecording) -> Finding:
    """Step `listening`: the adapter has confirmed that it only listens."""
    if heard.confirmed_silent:
        return passed(f"the adapter confirmed {heard.mapping.bitrate} bit/s and L (listen only)")
    return unchecked(
        f"{heard.name}: whether this interface stays silent cannot be asked for from here"
    )


def check_line(heard: CanRecording) -> Finding:
    """Step `line`: every line of the adapter is a frame, and none was lost in it."""
    problems = []
    if heard.line_faults:
        problems.append(f"{heard.line_faults} lines of the adapter are no frame")
    lost = (heard.status_flags or 0) & (QUEUE_FULL | OVERRUN)
    if lost:
        problems.append(f"the adapter lost frames: {_flags(lost)}")
    return failed(problems) if problems else passed(f"{heard.frames} frames, no fault")


def check_acknowledged(heard: CanRecording) -> Finding:
    """Step `acknowledged`: somebody acknowledges the controller; a listener does not."""
    if not heard.frames:
        return failed(
            f"nothing was heard in {heard.duration_s:.1f} s: bus silent, wrong bit rate, no "
            "cable, or a controller whose frames nobody acknowledges"
        )
    problems = []
    if heard.most_repeated >= LONGEST_ROW:
        problems.append(
            f"one frame came {heard.most_repeated + 1} times in a row: the controller repeats it "
            "for want of an acknowledge, and has become error-passive"
        )
    errors = (heard.status_flags or 0) & (WARNING | PASSIVE | BUS_ERROR)
    if errors:
        problems.append(f"the adapter's flags say {_flags(errors)}")
    if heard.error_frames:
        problems.append(f"{heard.error_frames} error frames")
    if problems:
        return failed(problems)
    told = "no error flag" if heard.status_flags is not None else "the adapter tells no flags"
    return passed(f"no frame is repeated, {told}: another node acknowledges, or the adapter does")


def check_messages(heard: CanRecording) -> Finding:
    """Step `messages`: every message that the arm file maps comes."""
    absent = [m.name for m in heard.messages if not len(m.arrivals_s) and not m.refused]
    names = ", ".join(f"{m.name} {len(m.arrivals_s)}" for m in heard.messages)
    if absent:
        return failed(
            f"{', '.join(absent)} never came; {heard.foreign} frames have identifiers the arm "
            "file does not map"
        )
    return passed(f"{names}; {heard.foreign} frames of other identifiers")


def check_rate(heard: CanRecording) -> Finding:
    """Step `rate`: every message comes as often as the arm file says."""
    problems, rates = [], []
    wanted_hz = heard.mapping.rate_hz
    for message in heard.messages:
        times = message.arrivals_s
        if len(times) < 2 or times[-1] <= times[0]:
            problems.append(f"{message.name}: {len(times)} frames came, too few for a rate")
            continue
        span_s = float(times[-1] - times[0])
        rate_hz = (len(times) - 1) / span_s
        rates.append(rate_hz)
        # One cycle and the host's latency are what the ends of the count leave open.
        open_s = 1.0 / wanted_hz + heard.latency_s
        if abs(rate_hz / wanted_hz - 1.0) > RATE_TOLERANCE + open_s / span_s:
            problems.append(f"{message.name}: {rate_hz:.2f} Hz, {wanted_hz:g} Hz in the arm file")
    if problems:
        return failed(problems)
    return passed(f"{min(rates):.2f} to {max(rates):.2f} Hz, {wanted_hz:g} Hz in the arm file")


def check_jitter(heard: CanRecording) -> Finding:
    """Step `jitter`: messages come evenly, not in bursts."""
    cycle_s = 1.0 / heard.mapping.rate_hz
    limit_s = LONG_GAP_CYCLES * cycle_s + heard.latency_s
    problems = []
    worst_s = spread_s = 0.0
    for message in heard.messages:
        gaps = np.diff(message.arrivals_s)
        if not len(gaps):
            continue
        long = gaps[gaps > limit_s]
        worst_s = max(worst_s, float(gaps.max()))
        spread_s = max(spread_s, float(gaps.std()))
        if len(long) > FEW_GAPS and float(long.sum()) > LONG_GAP_SHARE * heard.duration_s:
            problems.append(
                f"{message.name}: {len(long)} gaps beyond {1e3 * limit_s:.0f} ms, "
                f"{1e3 * float(long.max()):.0f} ms the longest, take "
                f"{100 * float(long.sum()) / heard.duration_s:.0f} % of the time"
            )
    if problems:
        return failed(problems)
    if worst_s == 0.0:
        return unchecked("too few frames came")
    return passed(
        f"cycle {1e3 * cycle_s:.1f} ms, standard deviation {1e3 * spread_s:.1f} ms, longest gap "
        f"{1e3 * worst_s:.1f} ms, the host's own lateness included"
    )


def check_counter(heard: CanRecording) -> Finding:
    """Step `counter`: the controller's counter rises by one from frame to frame."""
    if heard.mapping.counter is None:
        return unchecked("the arm file names no counter: lost frames cannot be told")
    problems = []
    counted = 0
    for message in heard.messages:
        with_counter = [u for u in message.updates if u.counter is not None]
        counted += len(with_counter)
        lost = sum(u.lost for u in with_counter)
        repeated = sum(u.repeated for u in with_counter)
        if lost:
            problems.append(f"{message.name}: {lost} frames lost by the counter")
        if repeated:
            problems.append(f"{message.name}: the counter stands still in {repeated} frames")
    if problems:
        return failed(problems)
    if not counted:
        return unchecked("no frame with a counter came")
    return passed(f"{counted} frames without a gap")


def check_staleness(heard: CanRecording) -> Finding:
    """Step `staleness`: no joint's angle ever becomes older than the arm file allows."""
    limit_s = heard.mapping.stale_after_s
    problems = []
    oldest_s = 0.0
    for joint in heard.mapping.joints:
        message = next(m for m in heard.messages if m.name == joint.message)
        told = [
            at_s
            for at_s, update in zip(message.arrivals_s, message.updates, strict=True)
            if joint.joint in update.joints_rad
        ]
        ages = np.diff([heard.begin_s, *told, heard.end_s])
        oldest_s = max(oldest_s, float(ages.max()))
        if float(ages.max()) > limit_s + heard.latency_s:
            problems.append(
                f"{joint.joint} was without an angle for {float(ages.max()):.2f} s, stale after "
                f"{limit_s:g} s"
            )
    return failed(problems) if problems else passed(f"never older than {1e3 * oldest_s:.0f} ms")


CAN_STEPS: tuple[Step[CanRecording], ...] = (
    Step(
        name="listening",
        title="Listening only",
        wanted="the adapter confirms that it neither acknowledges nor sends",
        hint="docs/can.md: bring the interface up silent, or use an slcan adapter that knows L",
        run=check_listening,
    ),
    Step(
        name="line",
        title="Adapter's line",
        wanted="every line is a frame; the adapter loses none",
        hint="baud rate or USB cable of the adapter; a faster adapter if its queue overflows",
        run=check_line,
    ),
    Step(
        name="acknowledged",
        title="Acknowledgement",
        wanted="frames once each and no bus error: somebody acknowledges the controller",
        hint="a controller alone with a listener repeats one frame and goes error-passive: the "
        "bus needs a second node that acknowledges, as the drives; check bit rate and terminators",
        run=check_acknowledged,
    ),
    Step(
        name="messages",
        title="Messages",
        wanted="every message that the arm file maps",
        hint="compare identifiers with the DBC file; does the controller send, and is it started?",
        run=check_messages,
    ),
    Step(
        name="rate",
        title="Rate",
        wanted="each message at the arm file's rate_hz, within 2 % and what the count leaves open",
        hint="set the controller's cycle, or rate_hz in the arm file",
        run=check_rate,
    ),
    Step(
        name="jitter",
        title="Jitter",
        wanted="even cycles: gaps beyond three cycles take less than a tenth of the time",
        hint="the controller's task priority, the adapter's buffering, the host's load",
        run=check_jitter,
    ),
    Step(
        name="counter",
        title="Counter",
        wanted="rises by one from frame to frame",
        hint="frames are lost in bus, adapter or host, or the controller has stopped",
        run=check_counter,
    ),
    Step(
        name="scale",
        title="Scale",
        wanted="every angle decodes and lies within the joint's range",
        hint="scale_deg, sign and offset_deg in the arm file; degrees or radians; byte order",
        run=check_scale,
    ),
    Step(
        name="resolution",
        title="Resolution",
        wanted="a bit is at most 0.01 degree",
        hint="map more bits of the angle",
        run=check_resolution,
    ),
    Step(
        name="drive-state",
        title="Drive state",
        wanted="a state that the database names, in every message that carries one",
        hint="held_values in the arm file, and the value table of the signal in the DBC file",
        run=check_drive_state,
    ),
    Step(
        name="still",
        title="Arm at rest",
        wanted="while the drives hold the arm no angle moves by more than 0.05 degree",
        hint="wrong byte order or sign shows as large steps; otherwise keep the arm still",
        run=check_still,
    ),
    Step(
        name="staleness",
        title="Staleness",
        wanted="no angle is ever older than stale_after_s",
        hint="no hit is accepted without fresh angles: find what makes the controller silent",
        run=check_staleness,
    ),
)


def check_can(
    channel: str,
    arm: Arm,
    *,
    duration_s: float = 10.0,
    clock: Clock | None = None,
    only: Iterable[str] = (),
    tell: Callable[[StepResult | str], None] = lambda _: None,
) -> Report:
    """Listen to a bus for a while, and judge what came.

    Parameters
    ----------
    channel
        As in `daq.can_listener.open_can`.
    duration_s
        How long to listen, lab seconds.

    Raises
    ------
    PortError, CanError, DeviceTimeoutError, DeviceLostError
        If the bus cannot be listened to.
    ArmError
        If the arm file has no CAN mapping.
    CheckError
        If a step is not known.
    """
    steps = choose(CAN_STEPS, only)
    clock = clock or SystemClock()
    mapping = mapping_of(arm)
    check_hears(channel, mapping)
    source = open_can(channel, mapping.bitrate)
    try:
        tell(f"Listening for {duration_s:g} s")
        heard = listen(source, arm, lab_s=duration_s, clock=clock, latency_wall_s=LATENCY_WALL_S)
    finally:
        source.close()
    return run_steps(source.name, steps, heard, make_ready=lambda _: None, tell=tell)
