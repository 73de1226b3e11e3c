"""An earlier session of the same arm: paths that it measured the other way round."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.checks import reciprocity
from armodal.analyzer.checks.records import Finding, Outcome
from armodal.analyzer.identification.estimate import estimate_frfs
from armodal.analyzer.modal import lines_within
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import SessionError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.plan_records import PlannedPosture
from armodal.protocols.session.hdf5 import read_session

__all__ = ["check_reciprocity", "earlier_frfs", "mirrors_in"]


def earlier_frfs(path: Path, arm: Arm) -> tuple[FrequencyResponse, ...]:
    """Read the FRFs of an earlier session of an arm, one a posture.

    Raises
    ------
    SessionError
        If the file cannot be read, or the session is of another arm.
    """
    session = read_session(path)
    theirs = session.header.arm
    if theirs.name != arm.name or {p.id for p in theirs.points} != {p.id for p in arm.points}:
        raise SessionError(
            f"--earlier {path}: wanted a session of {arm.name} with the same test points, got one "
            f"of {theirs.name}; leave it out"
        )
    return estimate_frfs(session, Superset(theirs))


def mirrors_in(
    earlier: Sequence[FrequencyResponse], posture: PlannedPosture
) -> FrequencyResponse | None:
    """Return the FRFs of the posture with these joint angles; None if there is none."""
    return next(
        (
            frf
            for frf in earlier
            if frf.joints_rad is not None
            and frf.joints_rad.shape == posture.joints_rad.shape
            and float(np.abs(frf.joints_rad - posture.joints_rad).max(initial=0.0))
            <= posture.tolerance_rad
        ),
        None,
    )


def check_reciprocity(now: FrequencyResponse, mirrors: FrequencyResponse) -> Finding | None:
    """Compare the paths of one point with the same paths measured the other way round.

    Returns
    -------
    The gravest finding; None if no path was measured both ways, or noise hides the answer.
    """
    band_hz = (
        float(max(now.freq_hz[0], mirrors.freq_hz[0])),
        float(min(now.freq_hz[-1], mirrors.freq_hz[-1])),
    )
    if band_hz[0] >= band_hz[1]:
        return None
    both = (
        lines_within(now, band_hz),
        lines_within(replace(mirrors, posture=now.posture), band_hz),
    )
    here = {dof.point for dof in (*now.responses, *now.references)}
    told = [
        finding
        for finding in reciprocity(both)
        if set(finding.points) == here and finding.outcome is not Outcome.CANNOT_TELL
    ]
    return max(told, key=lambda finding: finding.outcome is Outcome.FAULT, default=None)
