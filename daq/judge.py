"""Is the captured record one good hit? Judged in the time domain, on what was measured.

The limits, and what they let through, are in `docs/hit-judge.md`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.daq.blocks import CapturedBlock
from armodal.daq.judge_anti_alias import templates
from armodal.daq.judge_levels import FORCE, clipped, lost_in_noise, still_ringing, stuck, unsettled
from armodal.daq.judge_pulses import FEWEST_QUIET, Pulses, find_pulses
from armodal.protocols.board.records import BoardDictionary, Channel
from armodal.protocols.force_pulse import pulse_onset, pulse_polarity
from armodal.protocols.plan_records import Sampling, Trigger
from armodal.protocols.session.records import Verdict

__all__ = ["FORCE", "JudgeLimits", "channels_of", "force_column", "judge_record", "prepare_judge"]

Signal = npt.NDArray[np.float64]

_RINGING_REACH = 16  # samples before the trigger that a linear-phase filter may already move
_NAMED = 4  # pulses named in a note


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgeLimits:
    """Where the judge draws the line.

    double : second peak over the highest, both smoothed.
    contact : force between two pulses, over the lower one, above which it is a bounce.
    narrow : half width in samples below which a pulse shows the filter rather than itself.
    noise : peaks below this many standard deviations of the smoothed noise are noise.
    noise_floor : lowest peak force, in standard deviations of the force before and after.
    hidden : second pulse that the noise may hide without a note, over the highest.
    clip : share of an input's full scale that counts as overloaded; a converter's filter smears
        a clipped top, so it lies a little below 1.
    swing : force against the hit's direction, over the peak, that no hammer makes; a converter's
        filter makes no more than half of it.
    soft : lowest peak force, in trigger levels.
    late_s : longest time from trigger to peak; five samples are always allowed.
    cut : force over the peak that the pulse must fall to on either side within the record.
    settled : largest pre-trigger vibration (rms) over the peak of the response.
    decayed : largest vibration at the record's end over the peak of the response, windowed.
    moved : largest change of a joint from before to after, in tolerances of the posture.
    """

    double: float = 0.06
    contact: float = 0.25
    narrow: float = 2.2
    noise: float = 6.0
    noise_floor: float = 10.0
    hidden: float = 0.10
    clip: float = 0.98
    swing: float = 0.8
    soft: float = 2.0
    late_s: float = 0.02
    cut: float = 0.05
    settled: float = 0.15
    decayed: float = 0.05
    moved: float = 0.25


def prepare_judge() -> None:
    """Make the anti-alias templates, some 80 ms once a process, before a hit waits for them."""
    templates()


def channels_of(dictionary: BoardDictionary, channel_mask: int) -> tuple[Channel, ...]:
    """Return the channels in the mask, in the order of the record's columns."""
    return tuple(c for i, c in enumerate(dictionary.channels) if channel_mask >> i & 1)


def force_column(channels: tuple[Channel, ...]) -> int:
    """Return the column of the first force channel, or raise ValueError."""
    for column, channel in enumerate(channels):
        if channel.quantity == FORCE:
            return column
    raise ValueError("wanted a force channel, got " + ", ".join(c.quantity for c in channels))


def judge_record(
    block: CapturedBlock,
    channels: tuple[Channel, ...],
    sampling: Sampling,
    trigger: Trigger,
    limits: JudgeLimits | None = None,
    *,
    exponential_end: float = 1.0,
    polarity: int | None = None,
) -> Verdict:
    """Judge the samples of one block; posture and motion are judged elsewhere.

    Parameters
    ----------
    block
        Counts (n, n_channels).
    channels
        One for each column.
    exponential_end
        Value at the record's end of the window the analysis applies; 1 is none.
    polarity
        Sign of the recorded force of a push, where other hits of this hammer have told it; None
        finds it in this record.

    Returns
    -------
    Verdict
        `width_s` is the full width at half the peak, by straight lines between samples. `notes`
        say why a hit is rejected, and warn of what does not reject it.
    """
    limits = limits or JudgeLimits()
    found = _Findings(limits)
    if block.missing:
        found.reject("gap", f"{block.missing} of {block.info.length} samples never came")
    if not block.counts.shape[0]:
        return found.verdict(float("nan"), float("nan"))
    rate_hz = float(sampling.rate_hz)
    start = block.info.trigger_sample - block.first_sample
    force_n = _force(block, channels, start)
    usual = 1 if trigger.rising else -1
    polarity = polarity or pulse_polarity(force_n, usual)
    found.polarity = polarity
    force_n = polarity * force_n
    planned = sampling.pretrigger
    if polarity != usual:
        onset = pulse_onset(force_n)
        found.turned(late=onset < start)
        # The board triggered on what followed the pulse: the record is judged from the pulse on.
        planned = start = min(start, onset)
        force_n = polarity * _force(block, channels, start)
    pulses = find_pulses(
        force_n,
        rate_hz,
        highpass_hz=channels[force_column(channels)].highpass_hz,
        double=limits.double,
        noise=limits.noise,
        contact=limits.contact,
    )
    if overloaded := clipped(block.counts, channels, limits.clip):
        found.reject("overload", "at the end of the range: " + ", ".join(overloaded))
    if still := stuck(block.counts, channels, start):
        found.reject(
            "stuck", "a constant reading (stuck channel) after the hit: " + ", ".join(still)
        )
    found.strength(pulses, abs(trigger.level_n))
    found.swing(pulses, force_n)
    found.number(pulses, start, rate_hz)
    found.place(pulses, force_n, start, rate_hz, None if block.missing else planned)
    quiet = start - _RINGING_REACH
    if vibrating := unsettled(block.counts, channels, quiet, start, limits.settled):
        found.reject("not-settled", "still vibrating before the hit: " + ", ".join(vibrating))
    found.width(pulses)
    found.responses(block.counts, channels, quiet, start, exponential_end)
    return found.verdict(pulses.peak_n, pulses.half_width / rate_hz)


def _force(block: CapturedBlock, channels: tuple[Channel, ...], start: int) -> Signal:
    """Force in N as recorded, about zero before the hit."""
    column = force_column(channels)
    force_n: Signal = block.counts[:, column] * np.float64(channels[column].scale)
    quiet = force_n[: max(min(start, len(force_n)) - _RINGING_REACH, 0)]
    # A pulse is short beside its record, so the median of all is near zero force as well.
    about_zero: Signal = force_n - np.median(quiet if quiet.size >= FEWEST_QUIET else force_n)
    return about_zero


class _Findings:
    """Reasons and notes as they come up."""

    def __init__(self, limits: JudgeLimits) -> None:
        self._limits = limits
        self._reasons: list[str] = []
        self._notes: list[str] = []
        self.polarity = 1

    def turned(self, *, late: bool) -> None:
        """Say that the force is against the trigger's slope, and came before the trigger."""
        advice = (
            ". Reverse trigger.slope in the plan, so that the start of the pulse triggers"
            if late
            else ""
        )
        self._notes.append(
            "the hammer's polarity is reversed; the sign of its force was corrected" + advice
        )

    def reject(self, reason: str, note: str) -> None:
        self._reasons.append(reason)
        self._notes.append(note)

    def strength(self, pulses: Pulses, level_n: float) -> None:
        """Soft hits, and those that do not stand clear of the noise."""
        wanted_n = self._limits.soft * level_n
        if pulses.peak_n < wanted_n:
            self.reject("soft", f"peak {pulses.peak_n:.3g} N, wanted {wanted_n:.3g} N")
        if pulses.peak_n < self._limits.noise_floor * pulses.noise_n:
            self.reject(
                "noise",
                f"peak {pulses.peak_n:.3g} N, wanted {self._limits.noise_floor:.3g} times the "
                f"force's noise of {pulses.noise_n:.3g} N rms; hit harder or look at the cable",
            )
        elif pulses.hidden > self._limits.hidden:
            self._notes.append(
                f"a second pulse below {100 * pulses.hidden:.0f} % would be lost in the noise"
            )

    def swing(self, pulses: Pulses, force_n: Signal) -> None:
        """Force both ways, which is no hammer's."""
        trough_n = -float(force_n.min())
        if trough_n > self._limits.swing * pulses.peak_n:
            self.reject(
                "swing",
                f"the force swings to {-trough_n:.3g} N, and a hammer only pushes: look at its "
                "cable and supply",
            )

    def number(self, pulses: Pulses, start: int, rate_hz: float) -> None:
        """Double hits, and bounces in which the hammer never let go."""
        for reason, released, words in (
            ("double", True, "more than one pulse, at "),
            ("bounce", False, "the force rose again before the hammer lost contact, at "),
        ):
            others = [p for p in pulses.others if p.released == released]
            if others:
                self.reject(
                    reason,
                    words
                    + ", ".join(
                        f"{1e3 * (p.at - start) / rate_hz:.1f} ms ({100 * p.share:.0f} %)"
                        for p in others[:_NAMED]
                    ),
                )

    def place(
        self, pulses: Pulses, force_n: Signal, start: int, rate_hz: float, pretrigger: int | None
    ) -> None:
        """Pulses that come late, or lie partly outside the record."""
        after = pulses.peak_at - start
        if pretrigger is not None and (
            abs(start - pretrigger) > 1
            or not -2 <= after <= max(5.0, self._limits.late_s * rate_hz)
        ):
            self.reject("late", f"peak {1e3 * after / rate_hz:.1f} ms after the trigger")
        least_n = self._limits.cut * pulses.peak_n
        sides = (("before", force_n[: pulses.peak_at]), ("after", force_n[pulses.peak_at + 1 :]))
        cut = [word for word, side in sides if side.min(initial=np.inf) > least_n]
        if cut:
            self.reject("cut-off", f"part of the pulse lies {' and '.join(cut)} the record")

    def width(self, pulses: Pulses) -> None:
        """Say what a narrow pulse does not tell."""
        if pulses.half_width < self._limits.narrow:
            self._notes.append(
                f"cannot tell: the pulse is {pulses.half_width:.1f} samples wide at half its peak, "
                "less than the anti-alias filter shows; a second one close behind it would not be "
                "seen, nor are its height and width its own"
            )

    def responses(
        self,
        counts: npt.NDArray[np.int32],
        channels: tuple[Channel, ...],
        quiet: int,
        start: int,
        exponential_end: float,
    ) -> None:
        """Warn of responses that never rise from the noise, or have not decayed."""
        if lost := lost_in_noise(counts, channels, quiet, start):
            self._notes.append("no response above noise after the hit: " + ", ".join(lost))
        ringing = still_ringing(
            counts, channels, quiet, start, self._limits.decayed / exponential_end
        )
        if ringing:
            self._notes.append(
                "still ringing at the record's end: "
                + ", ".join(f"{name} {100 * share:.0f} % of its peak" for name, share in ringing)
                + "; record longer or let the exponential window fall further"
            )

    def verdict(self, peak_n: float, width_s: float) -> Verdict:
        return Verdict(
            accepted=not self._reasons,
            reasons=tuple(self._reasons),
            notes=tuple(self._notes),
            peak_n=peak_n,
            width_s=width_s,
            polarity=self.polarity,
        )
