"""A laboratory of fakes for the host, wired up."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from support.channels import channel
from support.fake_devices import RATE_HZ, FakeBoard, FakeController, dictionary

from armodal.protocols.arm.records import Arm
from armodal.protocols.board.messages import encode_dictionary
from armodal.protocols.plan import plan_from_text
from armodal.protocols.plan_records import Plan
from armodal.protocols.session.records import SessionHeader

PLAN = """
format = "armodal-plan-1"
name = "short"
arm = "rv4frl"
mode = "{mode}"
fixed_point = "1"
hits_per_point = 2
max_attempts = 3
[sampling]
rate_hz = 1652
samples = 256
pretrigger = 64
[trigger]
level_n = 8.0
slope = "rising"
[windows]
exponential_end = 0.03
[sensor]
mass_kg = 0.0093
[[postures]]
name = "test 1"
joints_deg = [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]
tolerance_deg = 0.5
points = ["2", "3"]
hit_direction = [0.0, -1.0, 0.0]
"""


def record(
    *,
    n: int = 256,
    pretrigger: int = 64,
    peak_n: float = 200.0,
    width_s: float = 3e-3,
    second: float = 0.0,
    second_after_s: float = 0.02,
    before_m_s2: float = 0.0,
    rng: np.random.Generator | None = None,
) -> np.ndarray:
    """Counts of a half-sine hit and the arm's answer at 12 Hz; a second pulse if wanted."""
    t = (np.arange(n) - pretrigger) / RATE_HZ

    def pulse(at_s: float) -> np.ndarray:
        inside = (t >= at_s) & (t < at_s + width_s)
        return np.where(inside, np.sin(np.pi * (t - at_s) / width_s), 0.0)

    force = peak_n * (pulse(-0.2 / RATE_HZ) + second * pulse(second_after_s))
    answer = np.where(t > 0.0, 5.0 * np.exp(-3.0 * t) * np.sin(2 * np.pi * 12.0 * t), 0.0)
    answer += before_m_s2 * np.sin(2 * np.pi * 12.0 * t)
    values = np.stack([force / 1e-4, answer / 1e-5, 0.3 * answer / 1e-5, answer / 1e-5], axis=1)
    if rng is not None:
        values += rng.normal(0.0, 100.0, values.shape)
    return np.clip(np.round(values), -8388608, 8388607).astype(np.int32)


@dataclass
class Lab:
    """Arm, plan, board and controller, wired up."""

    arm: Arm
    plan: Plan
    board: FakeBoard
    controller: FakeController
    journal: Path


@pytest.fixture(scope="session")
def plan(arm: Arm) -> Plan:
    return plan_from_text(PLAN.format(mode="roving-response"), arm)


@pytest.fixture(scope="session")
def hammer_plan(arm: Arm) -> Plan:
    text = PLAN.format(mode="roving-hammer").replace("hit_direction = [0.0, -1.0, 0.0]\n", "")
    return plan_from_text(text, arm)


@pytest.fixture
def board() -> Iterator[FakeBoard]:
    board = FakeBoard()
    board.start()
    yield board
    board.unplug()


@pytest.fixture
def controller(arm: Arm, plan: Plan) -> Iterator[FakeController]:
    controller = FakeController(arm, plan.postures[0].joints_rad.copy())
    controller.start()
    yield controller
    controller.unplug()


@pytest.fixture
def lab(
    arm: Arm,
    plan: Plan,
    board: FakeBoard,
    controller: FakeController,
    tmp_path: Path,
    real_time: None,
) -> Lab:
    return Lab(
        arm=arm,
        plan=plan,
        board=board,
        controller=controller,
        journal=tmp_path / "session.journal",
    )


@pytest.fixture
def fakes() -> dict[str, Callable[..., object]]:
    """Hand out the makers of fakes to tests that need more than one of a kind."""
    return {"record": record, "dictionary": dictionary, "channel": channel}


@pytest.fixture
def header(arm, plan, fakes):
    board = fakes["dictionary"]()
    return SessionHeader(
        session_id="ab12",
        created="2026-01-31T12:00:00+00:00",
        software="test",
        arm=arm,
        plan=plan,
        dictionary=board,
        dictionary_bytes=encode_dictionary(board),
        channel_mask=15,
        time_scale=1.0,
    )
