"""From readings to a session: counts, hits, header, as protocols lay them out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.makers.arm_table import Array
from armodal.hil_sim.pulse_width import half_width
from armodal.protocols.arm.records import Arm
from armodal.protocols.board.messages import encode_dictionary
from armodal.protocols.board.records import BoardDictionary, Channel, IepeState
from armodal.protocols.plan_records import Plan, PlannedPosture
from armodal.protocols.session.records import Hit, JointReading, Session, SessionHeader, Verdict

__all__ = ["Recorded", "Recorder", "session_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Recorder:
    """The recorder's inputs: force, then x, y and z of the accelerometer."""

    name: str
    full_scale: tuple[float, float]  # N, m/s^2
    bits: int
    highpass_hz: float

    @property
    def step(self) -> Array:
        """Unit per count of the four channels, (4,)."""
        force, acceleration = (full / 2 ** (self.bits - 1) for full in self.full_scale)
        return np.array([force, acceleration, acceleration, acceleration])


@dataclass(frozen=True, slots=True, kw_only=True)
class Recorded:
    """A hit as it was recorded."""

    posture: PlannedPosture
    sensor_point: str
    hit_point: str
    direction: Array  # (3,) unit, base frame, as it was wanted
    readings: Array  # (samples, 4) N and m/s^2
    joints_rad: Array  # (n_joints,) as the controller tells them


def session_of(
    arm: Arm, plan: Plan, recorder: Recorder, hits: Sequence[Recorded], created: str
) -> Session:
    """Return the session of all hits, each accepted, in the recorder's counts."""
    dictionary = _dictionary(recorder)
    records = tuple(_hit(plan, recorder, hit, i + 1) for i, hit in enumerate(hits))
    digest = sha256(plan.text.encode())
    for hit in records:
        digest.update(hit.counts.tobytes())
    header = SessionHeader(
        session_id=digest.hexdigest()[:32],
        created=created,
        software=recorder.name,
        arm=arm,
        plan=plan,
        dictionary=dictionary,
        dictionary_bytes=encode_dictionary(dictionary),
        channel_mask=0b1111,
        time_scale=1.0,
    )
    return Session(header=header, hits=records, losses=(), complete=True)


def _dictionary(recorder: Recorder) -> BoardDictionary:
    channels = []
    for i, name in enumerate(("force", "response x", "response y", "response z")):
        quantity, unit = ("force", "N") if i == 0 else ("acceleration", "m/s^2")
        channels.append(
            Channel(
                name=name,
                quantity=quantity,
                unit=unit,
                scale=float(recorder.step[i]),
                full_scale=recorder.full_scale[min(i, 1)],
                iepe=IepeState.OK,
                highpass_hz=recorder.highpass_hz,
                serial_number="",
                calibration_date="",
                teds=b"",
            )
        )
    return BoardDictionary(
        board_id=recorder.name,
        firmware="1",
        link_bytes_per_s=1_000_000,
        block_capacity=1 << 20,
        tick_hz=1_000_000,
        filter_group_delay_samples=0.0,
        channels=tuple(channels),
    )


def _hit(plan: Plan, recorder: Recorder, hit: Recorded, number: int) -> Hit:
    most = 2 ** (recorder.bits - 1) - 1
    counts: npt.NDArray[np.int32] = np.clip(
        np.rint(hit.readings / recorder.step), -most, most
    ).astype(np.int32)
    reading = JointReading(
        joints_rad=hit.joints_rad, drive_state=1, held=True, age_s=0.0, host_s=3.0 * number
    )
    force = hit.readings[:, 0]
    peak_n = float(np.max(force))
    first = 3 * number * plan.sampling.samples
    return Hit(
        number=number,
        posture=hit.posture.name,
        sensor_point=hit.sensor_point,
        hit_point=hit.hit_point,
        hit_direction=hit.direction,
        first_sample=first,
        trigger_sample=first + plan.sampling.pretrigger,
        trigger_host_s=3.0 * number,
        counts=counts,
        before=reading,
        after=reading,
        verdict=Verdict(
            accepted=True,
            reasons=(),
            notes=(),
            peak_n=peak_n,
            width_s=half_width(force) / float(plan.sampling.rate_hz),
        ),
    )
