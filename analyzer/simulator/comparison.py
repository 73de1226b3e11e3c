"""Measured FRFs beside those of a user's simulator, before and after the corrections."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.prediction import modes_of_arm
from armodal.analyzer.export.exported import BELOW_HZ, ready_for_export
from armodal.analyzer.export.frames import body_frames
from armodal.analyzer.export.mjcf_patch import link_bodies, patched_mjcf
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.analyzer.simulator.in_time import SimulatedArm, first_hits, simulated_session
from armodal.protocols.arm.records import Arm
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session

__all__ = ["PostureComparison", "compare_with_simulator", "simulated_arm"]

Array = npt.NDArray[np.float64]

_ABOVE = 1.5


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureComparison:
    """One posture: measured, and in the simulator with each of two arms."""

    posture: str
    validation: bool
    error_before: float  # rms of the difference over the rms of the measured, all FRFs
    error_after: float
    top_hz: float  # lines compared: to half as high again as the arm's highest mode
    measured: FrequencyResponse
    before: FrequencyResponse
    after: FrequencyResponse


def compare_with_simulator(
    session: Session,
    plain: Arm,
    corrected: Arm,
    source: Path,
    mujoco: Any,
    tell: Callable[[str], None],
) -> tuple[PostureComparison, ...]:
    """Simulate a session's hits in the user's MJCF with the plain and the corrected arm.

    Both arms are put into the same file, so that they differ by the corrections alone.

    Raises
    ------
    ArmError, EstimateError
        If the file is not of this arm, or cannot be simulated.
    """
    chosen = first_hits(session)
    tell("measured FRFs")
    measured = _frfs(chosen)
    found: dict[str, tuple[FrequencyResponse, ...]] = {}
    for when, arm in (("plain", plain), ("corrected", corrected)):
        tell(f"hits on the {when} arm, in time")
        found[when] = _frfs(simulated_session(chosen, simulated_arm(arm, source, mujoco)))
    held_out = {p.name for p in session.header.plan.postures if p.validation}
    top_hz = _ABOVE * _highest(corrected, measured)
    return tuple(
        PostureComparison(
            posture=own.posture,
            validation=own.posture in held_out,
            error_before=_error(own, before, top_hz),
            error_after=_error(own, after, top_hz),
            top_hz=top_hz,
            measured=own,
            before=before,
            after=after,
        )
        for own, before, after in zip(measured, found["plain"], found["corrected"], strict=True)
    )


def _highest(arm: Arm, measured: tuple[FrequencyResponse, ...]) -> float:
    """Return the highest mode of an arm in the postures, of those below 500 Hz."""
    angles = [frf.joints_rad for frf in measured if frf.joints_rad is not None]
    found = modes_of_arm(arm, np.rad2deg(angles).tolist(), below_hz=BELOW_HZ)
    return max(float(own.f_hz[-1]) for own in found)


def _frfs(session: Session) -> tuple[FrequencyResponse, ...]:
    return estimate_frfs(session, Superset(session.header.arm))


def simulated_arm(arm: Arm, source: Path, mujoco: Any) -> SimulatedArm:
    """Return a user's MJCF with an arm's springs and effects in it."""
    tree = ready_for_export(arm).tree
    text, _ = patched_mjcf(arm, tree, source, source, mujoco)
    bodies, before = link_bodies(arm, source)
    model = mujoco.MjModel.from_xml_path(str(source))
    return SimulatedArm(
        arm=arm,
        mujoco=mujoco,
        text=text,
        folder=source.absolute().parent,
        bodies=bodies,
        base=before,
        frames=body_frames(arm, mujoco, model, list(bodies), before),
        elastic=tree.elastic,
    )


def _error(measured: FrequencyResponse, simulated: FrequencyResponse, top_hz: float) -> float:
    """Over the responses and lines that both have: one that does not move has no FRF."""
    lines = min(
        int((measured.freq_hz < top_hz).sum()), measured.freq_hz.size, simulated.freq_hz.size
    )
    rows = {(dof.point, dof.label): i for i, dof in enumerate(simulated.responses)}
    both = [
        (i, rows[dof.point, dof.label])
        for i, dof in enumerate(measured.responses)
        if (dof.point, dof.label) in rows
    ]
    here, there = np.array(both).T
    own, other = measured.values[here][..., :lines], simulated.values[there][..., :lines]
    return float(np.linalg.norm(other - own) / np.linalg.norm(own))
