"""Sessions made in process: the simulated arm without ports, for tests of the analyzer."""

import json
import re
from datetime import UTC, datetime
from functools import partial

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.hil_sim.board_dictionary import board_dictionary
from armodal.hil_sim.hand import blow
from armodal.hil_sim.plant import load_plant
from armodal.hil_sim.source import SensorSource
from armodal.hil_sim.streams import stream
from armodal.protocols.arm.files import load_arm
from armodal.protocols.board.messages import encode_dictionary
from armodal.protocols.plan import load_plan, plan_from_text
from armodal.protocols.plan_records import Mode, Plan
from armodal.protocols.session.records import Hit, JointReading, Session, SessionHeader, Verdict

SETTLE = 200  # samples before the block, so that filters and noise are running


ALL_POINTS = tuple(str(i) for i in range(1, 19))
# Some on every link: stiffness and axis are found as well, an axis swapped at one point is not.
TEN_POINTS = ("1", "3", "5", "6", "7", "9", "12", "13", "15", "18")


def first_postures(n, points=TEN_POINTS):
    """The first postures of the shipped plan, at some of its points."""
    arm = load_arm("rv4frl")
    head, *blocks = load_plan("rv4frl-three-postures", arm).text.split("[[postures]]")
    listed = f"points = {json.dumps(list(points))}"
    few = [re.sub(r"points = \[[^\]]*\]", listed, block) for block in blocks[:n]]
    return plan_from_text("[[postures]]".join([head, *few]), arm, origin="test")


def simulate_session(
    seed, *, plan="rv4frl-three-postures", plant=None, arm=None, hits_per_point=None
):
    """Every planned point measured with good hits; encoders as good as a millidegree."""
    arm = arm or load_arm("rv4frl")
    plan = plan if isinstance(plan, Plan) else load_plan(plan, arm)
    plant = plant or load_plant("rv4frl")
    streams = partial(stream, seed)
    source = SensorSource(plant, plan.sampling.rate_hz, streams)
    good = plant.truth.hand.model_copy(
        update={"double_probability": 0.0, "soft_probability": 0.0, "overload_probability": 0.0}
    )
    hits = []
    for posture in plan.postures:
        source.set_posture(posture.joints_rad)
        normals = Superset(arm).posture(posture.joints_rad).point_rotation[:, :, 2]
        for point in posture.points:
            roving_hammer = plan.mode is Mode.ROVING_HAMMER
            sensor, hit = (plan.fixed_point, point) if roving_hammer else (point, plan.fixed_point)
            source.mount(sensor)
            # Without a planned direction the hammer goes along minus the surface's normal.
            planned = posture.hit_direction
            normal = normals[[p.id for p in arm.points].index(hit)]
            direction = -normal if planned is None else planned
            for _ in range(hits_per_point or plan.hits_per_point):
                number = len(hits) + 1
                hits.append(
                    one_hit(source, plan, posture, (sensor, hit, direction), good, streams, number)
                )
    dictionary = board_dictionary(plant.truth, tick_hz=1_000_000)
    header = SessionHeader(
        session_id="0" * 32,
        created=datetime(2026, 1, 1, tzinfo=UTC).isoformat(),
        software="armodal test",
        arm=arm,
        plan=plan,
        dictionary=dictionary,
        dictionary_bytes=encode_dictionary(dictionary),
        channel_mask=0b1111,
        time_scale=1.0,
    )
    return Session(header=header, hits=tuple(hits), losses=(), complete=True)


def one_hit(source, plan, posture, where, hand, streams, number):
    sensor, hit, direction = where
    delay = 20
    at = SETTLE + plan.sampling.pretrigger - delay + streams("begin", number).uniform()
    begin = source.next_sample
    source.strike(begin + at, blow(hand, streams("swing", number), hit, direction))
    source.read(SETTLE)
    counts = source.read(plan.sampling.samples)
    source.read(9000)  # rung out
    noise = streams("encoders", number).standard_normal(len(posture.joints_rad))
    angles = posture.joints_rad + np.deg2rad(1e-3) * noise
    reading = JointReading(
        joints_rad=angles, drive_state=2, held=True, age_s=0.004, host_s=float(number)
    )
    peak = float(counts[:, 0].max())
    return Hit(
        number=number,
        posture=posture.name,
        sensor_point=sensor,
        hit_point=hit,
        hit_direction=direction,
        first_sample=begin + SETTLE,
        trigger_sample=begin + SETTLE + plan.sampling.pretrigger,
        trigger_host_s=float(number),
        counts=counts,
        before=reading,
        after=reading,
        verdict=Verdict(accepted=True, reasons=(), notes=(), peak_n=peak, width_s=0.003),
    )
