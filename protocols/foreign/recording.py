"""A record of many hits, cut into hits by the pulses of its force.

Pulses that come closer than a hand can strike again are one hit: a double or a bounce, which the
judge tells. Every hit gets the same time from its pulse on, up to just before the next one; hits
that come much closer than usual are not given the room of others, so that their record holds two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.force_pulse import pulse_onset, pulse_polarity
from armodal.protocols.foreign.measured import Cut, ForeignHit, ToldDof

__all__ = ["Recording", "cut_recording"]

Signal = npt.NDArray[np.float64]

_APART_S = 0.2  # no hand strikes five times a second
_LEAST_SHARE = 0.05  # of the largest pulse: below, a touch and no hit
_CLEAR_OF_NOISE = 10.0  # standard deviations of the force beside its pulses, as the judge has it
_TOUCH_SHARE = 0.01  # of the largest pulse: touches that are said
_LEAD_SHARE = 0.05  # of the time between hits lies before a pulse
_USUAL = 0.5  # of the median time between hits: closer ones share a record
_DRIFT_S = 0.5  # a force's zero is its median over so long
_MAD = 1.4826  # standard deviation over median absolute deviation, normal noise
_MOST_HITS = 10_000
_NAMED = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """Forces of one hammer or more, beside the accelerations they cause."""

    origin: str
    rate_hz: Fraction
    forces_n: Signal  # (n_hammers, n)
    acceleration_m_s2: Signal  # (k, n)
    hammers: tuple[ToldDof, ...]  # n_hammers
    responses: tuple[ToldDof, ...]  # k


@dataclass(frozen=True, slots=True)
class _Event:
    """Pulses that are one hit."""

    at: int  # sample where the first begins
    last: int  # sample where the last has fallen
    peak_n: float
    hammer: int


def cut_recording(recording: Recording, cut: Cut, said: list[str]) -> list[ForeignHit]:
    """Return the hits of a recording; one with a single hit comes back whole.

    Parameters
    ----------
    recording
        One record of all channels.
    cut
        What the manifest says of it.
    said
        Sentences are added: how it was cut, and what lies between the hits.

    Raises
    ------
    ForeignFileError
        If there is no room for a record between the hits, or they are too many.
    """
    rate = float(recording.rate_hz)
    forces = np.stack([_about_zero(force, rate) for force in recording.forces_n])
    if not cut.wanted:
        return [_hit(recording, _strongest(forces), 0, forces.shape[1], recording.origin)]
    events, touches = _events(forces, rate, cut)
    if len(events) < 2 and cut.record_s is None:
        return [_hit(recording, _strongest(forces), 0, forces.shape[1], recording.origin)]
    if len(events) > _MOST_HITS:
        raise ForeignFileError(
            f"{recording.origin}: wanted at most {_MOST_HITS} hits, found {len(events)} pulses of "
            "force; say a level in `cut`, such as cut = { level_n = 5.0 }"
        )
    return _cut(recording, events, touches, cut, said)


def _cut(
    recording: Recording,
    events: Sequence[_Event],
    touches: Sequence[tuple[int, float]],
    cut: Cut,
    said: list[str],
) -> list[ForeignHit]:
    rate, n = float(recording.rate_hz), recording.forces_n.shape[1]
    at = np.array([event.at for event in events])
    room = np.diff(np.append(at, n))  # from every pulse to the next, or to the end
    between = room[:-1] if len(events) > 1 else room
    usual = between[between >= _USUAL * np.median(between)]
    lead = round((cut.pretrigger_s or _LEAD_SHARE * float(usual.min()) / rate) * rate)
    if cut.record_s is not None:
        behind = max(round(cut.record_s * rate) - lead, 1)
    else:
        behind = int(usual.min()) - lead
        if room[-1] >= _USUAL * np.median(between):
            behind = min(behind, int(room[-1]))
    if behind < 1:
        raise ForeignFileError(
            f"{recording.origin}: wanted room between its {len(events)} hits, the closest are "
            f"{usual.min() / rate:.3g} s apart and {lead / rate:.3g} s lie before a pulse; say "
            "`pretrigger_s` in `cut`"
        )
    whole = [event for event in events if event.at + behind <= n]
    hits = [
        _hit(
            recording,
            event.hammer,
            max(event.at - lead, 0),
            event.at + behind,
            f"{recording.origin}: hit {i + 1} at {event.at / rate:.3f} s",
        )
        for i, event in enumerate(whole)
    ]
    peaks = [event.peak_n for event in whole] or [0.0]
    taken = sum(len(hit.force_n) for hit in hits)
    said.append(
        f"{recording.origin}: {n / rate:.4g} s are cut into {len(hits)} hits by the force: "
        f"{(lead + behind) / rate:.4g} s each, {lead / rate:.3g} s of it before the pulse; peaks "
        f"{min(peaks):.3g} to {max(peaks):.3g} N; {max(n - taken, 0) / rate:.3g} s lie between them"
    )
    said += _between(recording, events, touches, lead, behind)
    return hits


def _between(
    recording: Recording,
    events: Sequence[_Event],
    touches: Sequence[tuple[int, float]],
    lead: int,
    behind: int,
) -> list[str]:
    """What of a recording is no good hit, or none at all."""
    rate, n = float(recording.rate_hz), recording.forces_n.shape[1]
    words = []
    if touches:
        largest = max(peak for _, peak in touches)
        when = _times([at for at, _ in touches], rate)
        words.append(
            f"{len(touches)} weaker pulses of up to {largest:.2g} N between the hits are passed "
            f"over, at {when}; say `level_n` in `cut` if they are hits"
        )
    close = [one.at for one, other in pairwise(events) if other.at - one.at < behind]
    if close:
        words.append(f"a second hit falls into the record of those at {_times(close, rate)}")
    ended = [event.at for event in events if event.at + behind > n]
    if ended:
        words.append(f"the recording ends within the hit at {_times(ended, rate)}: left out")
    if events[0].at < lead:
        words.append(
            f"the recording begins {events[0].at / rate:.3g} s before its first pulse, others have "
            f"{lead / rate:.3g} s"
        )
    return [f"{recording.origin}: {text}" for text in words]


def _times(samples: Sequence[int], rate: float) -> str:
    more = f" and {len(samples) - _NAMED} more" if len(samples) > _NAMED else ""
    return ", ".join(f"{at / rate:.2f} s" for at in samples[:_NAMED]) + more


def _events(forces: Signal, rate: float, cut: Cut) -> tuple[list[_Event], list[tuple[int, float]]]:
    """Hits of all hammers in order, and touches (sample, N) that are none."""
    apart = max(round((cut.apart_s or _APART_S) * rate), 1)
    found: list[_Event] = []
    touched: list[_Event] = []
    for hammer, force in enumerate(forces):
        push = pulse_polarity(force) * force
        largest = float(push.max(initial=0.0))
        if largest <= 0.0:
            continue
        noise = _CLEAR_OF_NOISE * _MAD * float(np.median(np.abs(force)))
        level = cut.level_n or max(_LEAST_SHARE * largest, noise)
        found += _pulses(push, level, apart, hammer)
        touched += _pulses(push, max(_TOUCH_SHARE * largest, noise), apart, hammer)
    events: list[_Event] = []
    for event in sorted(found, key=lambda one: one.at):
        # Two hammers cannot strike at once: the smaller one is the other's crosstalk.
        if events and event.at - events[-1].last < apart:
            events[-1] = max(events[-1], event, key=lambda one: one.peak_n)
        else:
            events.append(event)
    starts = np.array([event.at for event in events])
    touches = [
        (one.at, one.peak_n)
        for one in touched
        if not starts.size or np.min(np.abs(starts - one.at)) > apart
    ]
    return events, [touch for touch in touches if touch[1] < _smallest(events)]


def _smallest(events: Sequence[_Event]) -> float:
    return min((event.peak_n for event in events), default=np.inf)


def _pulses(push: Signal, level: float, apart: int, hammer: int) -> list[_Event]:
    """Where one hammer's force exceeds a level; what is less than `apart` away belongs to it."""
    above = np.flatnonzero(push >= level)
    if not above.size:
        return []
    breaks = np.flatnonzero(np.diff(above) > apart)
    firsts = above[np.append(0, breaks + 1)]
    lasts = above[np.append(breaks, above.size - 1)]
    events = []
    for first, last in zip(firsts.tolist(), lasts.tolist(), strict=True):
        # From the foot on: the level of a weak pulse may be near its top.
        begin = max(first - apart, 0)
        piece = push[begin : last + 1]
        peak = float(push[first : last + 1].max())
        foot = np.flatnonzero(piece[: first - begin + 1] < _LEAST_SHARE * peak)
        at = begin + (int(foot[-1]) + 1 if foot.size else pulse_onset(piece))
        events.append(_Event(min(at, first), last, peak, hammer))
    return events


def _about_zero(force: Signal, rate: float) -> Signal:
    """Force less its own zero, which may drift: the median of every half second."""
    block = max(round(_DRIFT_S * rate), 1)
    count = len(force) // block
    if count < 2:
        return force - float(np.median(force))
    middles = np.median(force[: count * block].reshape(count, block), axis=1)
    at = block * (np.arange(count) + 0.5)
    zero: Signal = np.interp(np.arange(len(force)), at, middles)
    return force - zero


def _strongest(forces: Signal) -> int:
    """Return the hammer that struck a record of one hit."""
    return int(np.argmax(np.abs(forces).max(axis=1)))


def _hit(recording: Recording, hammer: int, first: int, last: int, origin: str) -> ForeignHit:
    return ForeignHit(
        origin=origin,
        rate_hz=recording.rate_hz,
        force_n=frozen_array(recording.forces_n[hammer, first:last], np.float64),
        acceleration_m_s2=frozen_array(recording.acceleration_m_s2[:, first:last], np.float64),
        hit=recording.hammers[hammer],
        responses=recording.responses,
    )
