"""Hits of another program, judged as our own are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from armodal.daq.blocks import CapturedBlock
from armodal.daq.judge import FORCE, channels_of, judge_record
from armodal.protocols.arrays import frozen_array
from armodal.protocols.board.records import BlockInfo, Channel
from armodal.protocols.force_pulse import TURNED
from armodal.protocols.session.records import Hit, Session, Verdict

__all__ = ["judged"]

_FINER = 2**8  # imported counts to a step of 24 bits at half range


def judged(session: Session) -> Session:
    """Return the session with every hit judged as one of our own would be.

    Imported counts are finer than the board's 24 bits, and their range is not told: the judge gets
    them at half of its range, so that no hit is an overload. Records may begin at any time before
    their pulse: each is judged with its own pre-trigger.
    """
    header = session.header
    channels = tuple(
        replace(channel, scale=channel.scale * _FINER)
        for channel in channels_of(header.dictionary, header.channel_mask)
    )
    first = [_judged(hit, session, channels, None) for hit in session.hits]
    polarities = _polarities(session.hits, first)
    hits: list[Hit] = []
    warnings = list(session.warnings)
    for hit, alone in zip(session.hits, first, strict=True):
        polarity = polarities[_hammer(hit)]
        fits = alone.polarity == polarity
        verdict = alone if fits else _judged(hit, session, channels, polarity)
        notes = (*hit.verdict.notes, *verdict.notes)
        hits.append(replace(hit, verdict=replace(verdict, notes=notes)))
        if not verdict.accepted:
            warnings.append(f"{hit.verdict.notes[0]}: rejected: {', '.join(verdict.reasons)}")
    # A hit with several sensors is as many records of one origin.
    every = {hit.verdict.notes[0] for hit in hits}
    turned = {hit.verdict.notes[0] for hit in hits if hit.verdict.polarity < 0}
    if turned:
        warnings.append(f"{len(turned)} of {len(every)} hits: {TURNED}")
    return replace(session, hits=tuple(hits), warnings=tuple(dict.fromkeys(warnings)))


def _judged(
    hit: Hit, session: Session, channels: tuple[Channel, ...], polarity: int | None
) -> Verdict:
    # A sensor without an axis has zeros for it: nothing to be judged.
    there = hit.counts.any(axis=0) | np.array([c.quantity == FORCE for c in channels])
    counts = frozen_array(np.rint(hit.counts[:, there] / _FINER), np.int32)
    channels = tuple(c for c, is_there in zip(channels, there, strict=True) if is_there)
    info = BlockInfo(
        block_id=hit.number,
        first_sample=hit.first_sample,
        length=len(counts),
        trigger_sample=hit.trigger_sample,
        trigger_ticks=0,
    )
    block = CapturedBlock(
        info=info,
        first_sample=hit.first_sample,
        counts=counts,
        missing=0,
        last_data_s=hit.trigger_host_s,
        announced_s=hit.trigger_host_s,
    )
    plan = session.header.plan
    pretrigger = hit.trigger_sample - hit.first_sample
    sampling = replace(plan.sampling, pretrigger=pretrigger)
    return judge_record(block, channels, sampling, plan.trigger, polarity=polarity)


def _hammer(hit: Hit) -> tuple[str, tuple[float, ...]]:
    """What tells hammers apart: the point they hit, and the direction."""
    return hit.hit_point, tuple(np.round(hit.hit_direction, 6).tolist())


def _polarities(
    hits: Sequence[Hit], verdicts: Sequence[Verdict]
) -> dict[tuple[str, tuple[float, ...]], int]:
    """Sign of each hammer's force, by most of its hits."""
    total: Counter[tuple[str, tuple[float, ...]]] = Counter()
    for hit, verdict in zip(hits, verdicts, strict=True):
        total[_hammer(hit)] += verdict.polarity
    return {hammer: -1 if count < 0 else 1 for hammer, count in total.items()}
