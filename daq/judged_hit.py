"""A hit with its verdict: record and posture judged, as the journal keeps it."""

from __future__ import annotations

from armodal.daq.arm_around import ArmAround
from armodal.daq.geometry import hit_direction
from armodal.daq.judge import judge_record
from armodal.daq.judge_posture import with_posture
from armodal.daq.session_machine import Prompt
from armodal.daq.settings import AcquisitionSettings
from armodal.daq.triggered_blocks import HitBlock
from armodal.protocols.arm.records import Arm
from armodal.protocols.board.records import Channel
from armodal.protocols.plan_records import PlannedPosture
from armodal.protocols.session.records import Hit

__all__ = ["judged_hit"]


def judged_hit(
    taken: HitBlock,
    number: int,
    prompt: Prompt,
    posture: PlannedPosture,
    *,
    arm: Arm,
    around: ArmAround,
    channels: tuple[Channel, ...],
    polarity: int | None,
    settings: AcquisitionSettings,
) -> Hit:
    """Judge a block that belongs to the point asked for.

    Parameters
    ----------
    arm
        With the points where they are measured.
    polarity
        Sign of the hammer's channel that accepted hits have told, None before the first.
    """
    block, plan = taken.block, settings.plan
    verdict = with_posture(
        judge_record(
            block,
            channels,
            plan.sampling,
            plan.trigger,
            settings.limits,
            exponential_end=plan.windows.exponential_end,
            polarity=polarity,
        ),
        around.judged(taken.before, taken.after, posture),
    )
    return Hit(
        number=number,
        posture=posture.name,
        sensor_point=prompt.sensor_point,
        hit_point=prompt.hit_point,
        hit_direction=hit_direction(arm, posture, prompt.hit_point),
        first_sample=block.first_sample,
        trigger_sample=block.info.trigger_sample,
        trigger_host_s=taken.trigger_s,
        counts=block.counts,
        before=taken.before,
        after=taken.after,
        verdict=verdict,
    )
