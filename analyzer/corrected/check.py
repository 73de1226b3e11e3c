"""How well an arm file stands beside sessions: postures kept for validation first, and its age."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.arm.same_parts import check_same_parts
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.confidence import TWO_SIDED_95
from armodal.analyzer.corrected.prediction import predict_arm
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.analyzer.modal import fit_modes
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import EstimateError
from armodal.protocols.session.records import Session

__all__ = ["CheckedPosture", "KnownSession", "check_posture_rows", "known_sessions"]

_ABOVE = 1.3  # times the highest measured mode, to which predicted ones may pair


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownSession:
    """A session an arm file goes back to."""

    session_sha256: str
    by: str
    created: str
    days: float  # since
    given: bool  # among the files of this check


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedPosture:
    """Measured modes of a posture beside the arm file's."""

    posture: str
    validation: bool  # kept for validation when it was measured
    known: bool  # whether the arm file goes back to its session
    n_measured: int
    n_paired: int
    f_error: float | None  # largest relative difference of a frequency; None: nothing is paired
    damping_error: float | None  # likewise of a damping ratio
    within: int  # frequencies within 95 % of the prediction and the measurement together


def known_sessions(arm: Arm, given: set[str], now: datetime) -> tuple[KnownSession, ...]:
    """Return the sessions of an arm file's history and effects, oldest first."""
    found: dict[str, tuple[str, str]] = {}
    for own in arm.history:
        found[own.session_sha256] = own.by, own.created
    for effect in arm.effects:
        evidence = effect.evidence
        found.setdefault(evidence.session_sha256, (f"named {effect.name}", evidence.created))
    rows = [
        KnownSession(
            session_sha256=digest,
            by=by,
            created=created,
            days=(now - datetime.fromisoformat(created)).total_seconds() / 86400.0,
            given=digest in given,
        )
        for digest, (by, created) in found.items()
    ]
    return tuple(sorted(rows, key=lambda row: -row.days))


def check_posture_rows(arm: Arm, session: Session, *, known: bool) -> tuple[CheckedPosture, ...]:
    """Compare an arm file with every posture of a session.

    Raises
    ------
    ArmError
        If the session is of another arm.
    EstimateError
        If no posture of it shows a mode.
    """
    check_same_parts(session.header.arm, arm)
    held_out = {p.name for p in session.header.plan.postures if p.validation}
    rows = []
    for frf in estimate_frfs(session, Superset(session.header.arm)):
        modes = sorted(fit_modes(frf).modes, key=lambda mode: mode.f_hz)
        if not modes or frf.joints_rad is None:
            continue
        f = np.array([mode.f_hz for mode in modes])
        damping = np.array([mode.damping_ratio for mode in modes])
        std = np.array([mode.f_std_hz for mode in modes])
        (own,) = predict_arm(
            arm, [np.rad2deg(frf.joints_rad).tolist()], below_hz=_ABOVE * float(f[-1])
        )
        apart = np.abs(np.log(f[:, None] / own.modes.f_hz[None]))
        i, j = scipy.optimize.linear_sum_assignment(apart)
        off = np.abs(own.modes.f_hz[j] - f[i])
        room = TWO_SIDED_95 * np.hypot(own.f_std_hz[j], std[i])
        rows.append(
            CheckedPosture(
                posture=frf.posture,
                validation=frf.posture in held_out,
                known=known,
                n_measured=len(f),
                n_paired=len(i),
                f_error=_largest(off / f[i]),
                damping_error=_largest(own.modes.damping_ratio[j] / damping[i] - 1.0),
                within=int((off <= room).sum()),
            )
        )
    if not rows:
        raise EstimateError("no posture of the session shows a mode: nothing can be compared")
    return tuple(rows)


def _largest(differences: npt.NDArray[np.float64]) -> float | None:
    return float(np.abs(differences).max()) if differences.size else None
