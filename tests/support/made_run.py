"""Events as the acquisition process sends them, made for the screens."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from armodal.daq.events import (
    BoardFound,
    Finished,
    HitJudged,
    JointsSeen,
    Preview,
    Prompted,
    SessionOpened,
    TrialHit,
)
from armodal.daq.session_machine import SessionState, begin, point_ready, posture_reached
from armodal.protocols.arm.files import load_arm
from armodal.protocols.board.records import BoardDictionary, Channel, IepeState
from armodal.protocols.plan import load_plan
from armodal.protocols.session.records import Hit, JointReading, Verdict
from armodal.tui.screens.run.happenings import (
    Happening,
    LabWanted,
    SafeConfirmed,
    SessionWanted,
    Tick,
)
from armodal.tui.screens.run.reducer import reduce
from armodal.tui.screens.run.state import RunState, begin_state

ARM = load_arm("rv4frl")
PLAN = load_plan("rv4frl-three-postures", ARM)
HAMMER_PLAN = load_plan("rv4frl-roving-hammer", ARM)
FORCE_SCALE, ACCELERATION_SCALE = 1e-3, 1e-5
BOARD = BoardFound(
    port="/dev/ttyACM0",
    channel_mask=0b1111,
    dictionary=BoardDictionary(
        board_id="board-7",
        firmware="1.0",
        link_bytes_per_s=1_000_000,
        block_capacity=500_000,
        tick_hz=1_000_000,
        filter_group_delay_samples=0.0,
        channels=tuple(
            Channel(
                name=name,
                quantity=quantity,
                unit="N" if quantity == "force" else "m/s^2",
                scale=scale,
                full_scale=scale * 2**23,
                iepe=IepeState.OK,
                highpass_hz=0.5,
                serial_number=f"S-{name}",
                calibration_date="2026-03-02",
                teds=b"",
            )
            for name, quantity, scale in (
                ("hammer", "force", FORCE_SCALE),
                ("acc_x", "acceleration", ACCELERATION_SCALE),
                ("acc_y", "acceleration", ACCELERATION_SCALE),
                ("acc_z", "acceleration", ACCELERATION_SCALE),
            )
        ),
    ),
)


def reading(joints_rad: Any = PLAN.postures[0].joints_rad, *, held: bool = True) -> JointsSeen:
    known = None if joints_rad is None else np.asarray(joints_rad, dtype=np.float64)
    return JointsSeen(
        reading=JointReading(joints_rad=known, drive_state=2, held=held, age_s=0.01, host_s=1.0),
    )


def prompted(session: SessionState) -> Prompted:
    return Prompted(prompt=session.prompt, host_s=1.0, progress=session.progress)


def preview(first: int = 0, n: int = 165, high: int = 50) -> Preview:
    bins = np.full((64, 4), high, dtype=np.int32)
    return Preview(first_sample=first, n_samples=n, lowest=-bins, highest=bins)


def counts(peak_n: float = 100.0, n: int = 2048, pretrigger: int = 100) -> np.ndarray:
    """A half-sine pulse of 2 ms and a decaying answer at 20 Hz."""
    rate_hz = float(PLAN.sampling.rate_hz)
    t = (np.arange(n) - pretrigger) / rate_hz
    force = np.where((t >= 0) & (t < 2e-3), np.sin(np.pi * t / 2e-3), 0.0) * peak_n
    answer = np.where(t > 0, np.exp(-5.0 * t) * np.sin(2 * np.pi * 20.0 * t), 0.0) * peak_n / 100.0
    noise = np.random.default_rng(4).normal(0.0, 20.0, (n, 4))
    values = np.stack(
        [force / FORCE_SCALE, *(a * answer / ACCELERATION_SCALE for a in (1.0, 0.5, 0.2))], axis=1
    )
    return np.round(values + noise).astype(np.int32)


def judged(
    number: int = 1,
    *reasons: str,
    point: str = "1",
    posture: str = "test 1",
    at_s: float = 10.0,
    hit_point: str = "1",
) -> HitJudged:
    seen = reading().reading
    hit = Hit(
        number=number,
        posture=posture,
        sensor_point=point,
        hit_point=hit_point,
        hit_direction=np.array([0.0, -1.0, 0.0]),
        first_sample=1000,
        trigger_sample=1100,
        trigger_host_s=at_s,
        counts=counts(),
        before=seen,
        after=seen,
        verdict=Verdict(
            accepted=not reasons,
            reasons=tuple(reasons),
            notes=tuple(f"note on {reason}" for reason in reasons),
            peak_n=100.0,
            width_s=1.2e-3,
        ),
    )
    return HitJudged(hit=hit, verdict_s=0.01, commit_s=0.002, clock_uncertainty_s=1e-4)


def finished(**changes: Any) -> Finished:
    """Return how an acquisition ends."""
    return replace(
        Finished(
            complete=True,
            reason="done",
            journal="x",
            accepted=1,
            rejected=0,
            cpu_s=0.0,
            previews_dropped=0,
            samples_taken=None,
            samples_seen=0,
        ),
        **changes,
    )


def trial(peak_n: float = 100.0, noise_n: float = 0.1) -> TrialHit:
    made = judged().hit
    return TrialHit(
        counts=made.counts,
        first_sample=made.first_sample,
        trigger_sample=made.trigger_sample,
        verdict=replace(made.verdict, peak_n=peak_n),
        force_noise_n=noise_n,
    )


def mass_hit(mass_kg: float) -> TrialHit:
    """A hit on a mass that moves freely, along the third axis."""
    made = trial(100.0)
    values = made.counts.copy()
    values[:, 3] = np.round(values[:, 0] * FORCE_SCALE / mass_kg / ACCELERATION_SCALE)
    values[:, 1:3] = 0
    return replace(made, counts=values)


def after(state: RunState, *events: Happening) -> RunState:
    for event in events:
        state = reduce(state, event)
    return state


AT_POSTURE = begin(PLAN)
AT_POINT = posture_reached(AT_POSTURE)
AT_HIT = point_ready(AT_POINT)
OPENED = SessionOpened(session_id="ab", journal="x.journal", hits_before=0, warnings=())
LAB_EVENTS: tuple[Happening, ...] = (
    Tick(now_s=100.0),
    LabWanted(board_port="/dev/ttyACM0", can_channel="/dev/ttyACM1", simulated=False),
    BOARD,
    reading(),
    preview(),
)
SESSION_EVENTS: tuple[Happening, ...] = (
    *LAB_EVENTS,
    SessionWanted(),
    OPENED,
    prompted(AT_POSTURE),
    reading(),
)
HIT_EVENTS: tuple[Happening, ...] = (
    *SESSION_EVENTS,
    prompted(AT_POINT),
    SafeConfirmed(),
    prompted(AT_HIT),
    preview(),
)


def fresh(plan: Any = PLAN) -> RunState:
    return begin_state(ARM, plan)
