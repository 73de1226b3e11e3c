"""Hits of another program, judged as our own are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.daq.blocks import CapturedBlock
from armodal.daq.judge import channels_of, judge_record
from armodal.protocols.arrays import frozen_array
from armodal.protocols.board.records import BlockInfo
from armodal.protocols.session.records import Hit, Session

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
    hits: list[Hit] = []
    warnings = list(session.warnings)
    for hit in session.hits:
        counts = frozen_array(np.rint(hit.counts / _FINER), np.int32)
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
        pretrigger = hit.trigger_sample - hit.first_sample
        sampling = replace(header.plan.sampling, pretrigger=pretrigger)
        verdict = judge_record(block, channels, sampling, header.plan.trigger)
        notes = (*hit.verdict.notes, *verdict.notes)
        hits.append(replace(hit, verdict=replace(verdict, notes=notes)))
        if not verdict.accepted:
            warnings.append(f"{hit.verdict.notes[0]}: rejected: {', '.join(verdict.reasons)}")
    return replace(session, hits=tuple(hits), warnings=tuple(warnings))
