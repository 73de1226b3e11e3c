"""A session of the plan, made in process: every point, good hits, a person's aim and mounting."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from hashlib import sha256

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.board_dictionary import board_dictionary
from armodal.hil_sim.front_end import FULL_SCALE_COUNTS, FrontEnd
from armodal.hil_sim.hand import blow, hand_at
from armodal.hil_sim.noise import ChannelNoise
from armodal.hil_sim.plant import Plant
from armodal.hil_sim.pulse_width import half_width
from armodal.hil_sim.ringing import Strike, ring
from armodal.hil_sim.small_motion import linearise
from armodal.hil_sim.source import draw_mounting, strike_of
from armodal.hil_sim.streams import Streams, stream
from armodal.protocols.arm.records import Arm
from armodal.protocols.board.messages import encode_dictionary
from armodal.protocols.plan_records import Plan, PlannedPosture
from armodal.protocols.session.records import Hit, JointReading, Session, SessionHeader, Verdict

__all__ = ["measured"]

Array = npt.NDArray[np.float64]

AIM_DEG = 0.8  # how far the wanted direction of a posture's hits is missed, about each axis
ENCODER_NOISE_DEG = 1e-3
LOUDEST = 0.9 * FULL_SCALE_COUNTS  # beyond, a hit is judged overloaded
SOFTER = 5  # times that a point is hit again
GAP_SAMPLES = 4000  # from one hit's record to the next


@dataclass(frozen=True, slots=True, kw_only=True)
class _Planned:
    posture: PlannedPosture
    point: str
    strike: Strike
    streams: Streams  # of what goes on while this hit is recorded


def measured(
    plant: Plant,
    arm: Arm,
    plan: Plan,
    seed: int,
    levels_n: tuple[float, ...] | None = None,
    run: int = 0,
) -> Session:
    """Measure a roving-response plan with a fixed hammer.

    Parameters
    ----------
    arm
        As its user believes it; it goes into the session.
    levels_n
        Peak forces to go through at each point, one a hit, each hit to 10 % ; None draws every
        peak from the hand's own interval. As many hits are made as the plan has, or as there are
        levels.
    run
        Number of the measurement: another one has other swings, tilts and noise. Each is drawn by
        posture, point and hit, whatever else the plan has.

    Returns
    -------
    Session
        Complete; the true joint angles differ from the readings by the encoders' offsets.
    """
    streams = partial(stream, seed, "measurement", run)
    front = FrontEnd(plant.truth, plan.sampling.rate_hz)
    planned = [
        hit
        for posture in plan.postures
        for hit in _strikes(plant, plan, posture, levels_n, partial(streams, posture.name))
    ]
    rung = _rung(plant, front, plan, [hit.strike for hit in planned])
    hits: list[Hit] = []
    for hit, counts in zip(planned, rung, strict=True):
        recorded = _recorded(plant, front, hit, counts)
        force_n = recorded[:, 0] / front.counts_per_unit[0]
        hits.append(_hit(plan, hit, recorded, force_n, len(hits) + 1))
    dictionary = board_dictionary(plant.truth, tick_hz=1_000_000)
    header = SessionHeader(
        session_id=_session_id(plant, seed, run),
        created=datetime(2026, 1, 1, tzinfo=UTC).isoformat(),
        software="armodal sealed case",
        arm=arm,
        plan=plan,
        dictionary=dictionary,
        dictionary_bytes=encode_dictionary(dictionary),
        channel_mask=0b1111,
        time_scale=1.0,
    )
    return Session(header=header, hits=tuple(hits), losses=(), complete=True)


def _session_id(plant: Plant, seed: int, run: int) -> str:
    """Return 32 hexadecimal digits that tell sessions apart and nothing of the seed."""
    text = f"{seed} {run} {plant.truth.model_dump_json()}"
    return sha256(text.encode()).hexdigest()[:32]


def _rung(plant: Plant, front: FrontEnd, plan: Plan, strikes: list[Strike]) -> list[Array]:
    """Counts of every strike; one that overdrives the sensor is made again half as hard."""
    delays, samples = plant.sensing.delay_s, plan.sampling.samples
    rung = ring(front, strikes, delays, samples)
    for _ in range(SOFTER):
        loud = [i for i, counts in enumerate(rung) if np.max(np.abs(counts)) > LOUDEST]
        if not loud:
            break
        strikes = [_softer(strike) if i in loud else strike for i, strike in enumerate(strikes)]
        for i, counts in zip(
            loud, ring(front, [strikes[i] for i in loud], delays, samples), strict=True
        ):
            rung[i] = counts
    return rung


def _softer(strike: Strike) -> Strike:
    pulses = tuple(replace(pulse, peak_n=0.5 * pulse.peak_n) for pulse in strike.blow.pulses)
    return replace(strike, blow=replace(strike.blow, pulses=pulses))


def _strikes(
    plant: Plant,
    plan: Plan,
    posture: PlannedPosture,
    levels_n: tuple[float, ...] | None,
    streams: Streams,
) -> list[_Planned]:
    """All hits of a posture, point by point."""
    if posture.hit_direction is None:
        raise ValueError(f"posture {posture.name!r} has no hit_direction; a fixed hammer needs one")
    aim = _missed(posture.hit_direction, streams("aim"))
    rate_hz = float(plan.sampling.rate_hz)
    planned = []
    for point in posture.points:
        place = plant.sensing.stands_at.get(point, point)
        mounting = draw_mounting(plant, place, streams("mount", point))
        motion = linearise(plant, posture.joints_rad, mounting)
        for i in range(len(levels_n) if levels_n else plan.hits_per_point):
            of_hit = partial(streams, point, i)
            hand = hand_at(plant.truth.hand, levels_n[i] if levels_n else None)
            swing = blow(hand, of_hit("swing"), plan.fixed_point, aim)
            begin = plan.sampling.pretrigger - plant.truth.board.filter_delay_samples
            begin_s = (begin + float(of_hit("begin").uniform())) / rate_hz
            strike = strike_of(plant, motion, swing, begin_s)
            planned.append(_Planned(posture=posture, point=point, strike=strike, streams=of_hit))
    return planned


def _missed(direction: Array, rng: np.random.Generator) -> Array:
    """The direction that all hits of a posture truly have on average."""
    across = np.linalg.svd(direction[None, :])[2][1:]
    wanted = direction + np.deg2rad(AIM_DEG) * np.clip(rng.standard_normal(2), -2.0, 2.0) @ across
    result: Array = wanted / np.linalg.norm(wanted)
    return result


def _recorded(
    plant: Plant, front: FrontEnd, planned: _Planned, counts: Array
) -> npt.NDArray[np.int32]:
    """Gains, noise, the hidden window and the converter."""
    n = len(counts)
    record = counts @ plant.sensing.gains(planned.point).T
    record += ChannelNoise(plant.truth, front, planned.streams).read(n)
    record = np.clip(record, -FULL_SCALE_COUNTS - 1, FULL_SCALE_COUNTS)
    record *= plant.sensing.window_end ** (np.arange(n) / n)[:, None]
    result: npt.NDArray[np.int32] = np.rint(record).astype(np.int32)
    return result


def _hit(
    plan: Plan,
    planned: _Planned,
    counts: npt.NDArray[np.int32],
    force_n: Array,
    number: int,
) -> Hit:
    posture, peak_n = planned.posture, float(np.max(force_n))
    noise = np.deg2rad(ENCODER_NOISE_DEG) * planned.streams("encoders").standard_normal(
        len(posture.joints_rad)
    )
    reading = JointReading(
        joints_rad=posture.joints_rad + noise,
        drive_state=2,
        held=True,
        age_s=0.004,
        host_s=float(number),
    )
    first = (number - 1) * (plan.sampling.samples + GAP_SAMPLES)
    direction = posture.hit_direction
    return Hit(
        number=number,
        posture=posture.name,
        sensor_point=planned.point,
        hit_point=plan.fixed_point,
        hit_direction=np.zeros(3) if direction is None else direction,
        first_sample=first,
        trigger_sample=first + plan.sampling.pretrigger,
        trigger_host_s=float(number),
        counts=counts,
        before=reading,
        after=reading,
        verdict=Verdict(
            accepted=True,
            reasons=(),
            notes=(),
            peak_n=peak_n,
            width_s=half_width(force_n) / float(plan.sampling.rate_hz),
        ),
    )
