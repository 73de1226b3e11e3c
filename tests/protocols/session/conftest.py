"""A small session of the shipped arm and plan, and the bytes of its journal."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from armodal.protocols.arm.files import load_arm
from armodal.protocols.board.messages import encode_dictionary
from armodal.protocols.board.records import BoardDictionary, Channel, IepeState
from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm
from armodal.protocols.plan import load_plan
from armodal.protocols.session.hdf5 import write_session
from armodal.protocols.session.journal import (
    End,
    Mark,
    MarkKind,
    begin_journal,
    encode_end,
    encode_hit,
    encode_loss,
    encode_mark,
)
from armodal.protocols.session.records import (
    Hit,
    JointReading,
    Loss,
    Session,
    SessionHeader,
    Verdict,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Example:
    """A session, and the records of its journal one by one."""

    session: Session
    records: tuple[bytes, ...]

    @property
    def journal(self) -> bytes:
        return b"".join(self.records)


def _channel(name: str, quantity: str, unit: str, scale: float) -> Channel:
    return Channel(
        name=name,
        quantity=quantity,
        unit=unit,
        scale=scale,
        full_scale=scale * 2**23,
        iepe=IepeState.OK,
        highpass_hz=0.5,
        serial_number=f"SN {name}",
        calibration_date="2025-03-01",
        teds=bytes(range(16)),
    )


@pytest.fixture(scope="session")
def header() -> SessionHeader:
    arm = load_arm("rv4frl")
    dictionary = BoardDictionary(
        board_id="board 1",
        firmware="1.0",
        link_bytes_per_s=1_000_000,
        block_capacity=1 << 20,
        tick_hz=1_000_000,
        filter_group_delay_samples=39.0,
        channels=(
            _channel("hammer", "force", "N", 2.6e-4),
            _channel("acc_x", "acceleration", "m/s^2", 1.2e-5),
            _channel("acc_y", "acceleration", "m/s^2", 1.2e-5),
            _channel("acc_z", "acceleration", "m/s^2", 1.2e-5),
        ),
    )
    return SessionHeader(
        session_id="0123abcd",
        created="2025-06-01T10:00:00Z",
        software="armodal 0.1.0",
        arm=arm,
        plan=load_plan("rv4frl-three-postures", arm),
        dictionary=dictionary,
        dictionary_bytes=encode_dictionary(dictionary),
        channel_mask=0b1111,
        time_scale=1.0,
        measured_by="shift two",
    )


@pytest.fixture(scope="session")
def make_hit(header: SessionHeader) -> Callable[..., Hit]:
    """Return a function that makes hit `number`, rejected where `reasons` are given."""
    posture = header.plan.postures[0]

    def make(
        number: int,
        *,
        samples: int = 8,
        sensor_point: str = "2",
        posture_name: str = posture.name,
        reasons: tuple[str, ...] = (),
    ) -> Hit:
        rng = np.random.default_rng(number)
        first = 10_000 * number
        known = JointReading(
            joints_rad=posture.joints_rad, drive_state=4, held=True, age_s=0.01, host_s=1.5 * number
        )
        silent = JointReading(
            joints_rad=None, drive_state=None, held=False, age_s=math.inf, host_s=1.5 * number
        )
        return Hit(
            number=number,
            posture=posture_name,
            sensor_point=sensor_point,
            hit_point="1",
            hit_direction=np.array([0.0, 0.6, -0.8]),
            first_sample=first,
            trigger_sample=first + 3,
            trigger_host_s=0.1 + number,
            counts=rng.integers(-(2**23), 2**23, (samples, 4), dtype=np.int32),
            before=known,
            after=silent if "stale" in reasons else known,
            verdict=Verdict(
                accepted=not reasons,
                reasons=reasons,
                notes=("peak below the plan's — “soft”",),
                peak_n=41.5,
                width_s=math.nan if reasons else 0.004,
            ),
        )

    return make


@pytest.fixture(scope="session")
def example(header: SessionHeader, make_hit: Callable[..., Hit]) -> Example:
    hits = (make_hit(1), make_hit(2, reasons=("double", "stale")), make_hit(3, samples=5))
    losses = (
        Loss(kind="stream", count=64, first_sample=128, host_s=3.25, note="preview only"),
        Loss(kind="can", count=2, first_sample=None, host_s=4.0, note=""),
    )
    begun = Mark(kind=MarkKind.POSTURE, posture="test 1", point=None, host_s=0.5)
    skipped = Mark(
        kind=MarkKind.SKIPPED, posture="test 1", point="7", host_s=5.0, note="out of reach"
    )
    records = (
        begin_journal(header),
        encode_mark(begun),
        encode_hit(hits[0]),
        encode_loss(losses[0]),
        encode_hit(hits[1]),
        encode_loss(losses[1]),
        encode_hit(hits[2]),
        encode_mark(skipped),
        encode_end(End(reason="operator", host_s=9.0)),
    )
    session = Session(
        header=header,
        hits=hits,
        losses=losses,
        complete=False,
        warnings=("skipped: posture test 1, point 7: out of reach",),
    )
    return Example(session=session, records=records)


@pytest.fixture(scope="session")
def frfs(header: SessionHeader) -> tuple[FrequencyResponse, ...]:
    rng = np.random.default_rng(5)
    axes = np.eye(3)
    responses = tuple(
        Dof(point="2", label=label, direction=axis) for label, axis in zip("xyz", axes, strict=True)
    )
    references = (Dof(point="1", label="hit", direction=np.array([0.0, 0.6, -0.8])),)

    def one(posture: str, joints: np.ndarray | None) -> FrequencyResponse:
        shape = (3, 1, 6)
        return FrequencyResponse(
            posture=posture,
            form=FrfForm.ACCELERANCE,
            freq_hz=np.arange(1, 7) * 0.81,
            decay_rad_s=2.8,
            values=rng.normal(size=shape) + 1j * rng.normal(size=shape),
            coherence=rng.uniform(size=shape),
            variance=np.full(shape, np.inf),
            n_hits=np.full((3, 1), 3, dtype=np.int64),
            responses=responses,
            references=references,
            joints_rad=joints,
        )

    return (one("test 1", header.plan.postures[0].joints_rad), one("test 2", None))


@pytest.fixture(scope="session")
def written_bytes(
    example: Example, frfs: tuple[FrequencyResponse, ...], tmp_path_factory: pytest.TempPathFactory
) -> bytes:
    """The session file of the example, with its FRFs."""
    path = tmp_path_factory.mktemp("written") / "a.h5"
    write_session(example.session, path, frfs=frfs)
    return path.read_bytes()


@pytest.fixture
def written(written_bytes: bytes, tmp_path: Path) -> Path:
    """The same in a file that a test may harm."""
    path = tmp_path / "a.h5"
    path.write_bytes(written_bytes)
    return path
