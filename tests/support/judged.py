"""A force record as a captured block, and the judge's word on it."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import numpy.typing as npt
from support.channels import channel

from armodal.daq.blocks import CapturedBlock
from armodal.daq.judge import judge_record
from armodal.protocols.board.records import BlockInfo
from armodal.protocols.plan_records import Sampling, Trigger
from armodal.protocols.session.records import Verdict

__all__ = ["LEVEL_N", "block_of_counts", "judge_force", "sees_two"]

LEVEL_N = 8.0
N_PER_COUNT = 1e-4


def block_of_counts(counts: npt.NDArray[np.int32], trigger: int) -> CapturedBlock:
    return CapturedBlock(
        info=BlockInfo(
            block_id=1,
            first_sample=0,
            length=len(counts),
            trigger_sample=trigger,
            trigger_ticks=0,
        ),
        first_sample=0,
        counts=counts,
        missing=0,
        last_data_s=0.0,
        announced_s=0.0,
    )


def judge_force(
    force_n: npt.NDArray[np.float64], rate_hz: float, pretrigger: int, highpass_hz: float
) -> Verdict:
    """The judge's word at its default setting on a force record alone."""
    counts = np.round(force_n / N_PER_COUNT).astype(np.int32)[:, None]
    return judge_record(
        block_of_counts(counts, pretrigger),
        (channel("hammer", "force", N_PER_COUNT, highpass_hz),),
        Sampling(rate_hz=Fraction(rate_hz), samples=len(counts), pretrigger=pretrigger),
        Trigger(level_n=LEVEL_N, rising=True),
    )


def sees_two(verdict: Verdict) -> bool:
    """Whether the verdict names a second pulse."""
    return not {"double", "bounce"}.isdisjoint(verdict.reasons)
