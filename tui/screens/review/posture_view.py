"""What review shows of one posture: FRFs, modes, and what moves in each of them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.estimate import estimate_frfs
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.analyzer.identification.structural import STRUCTURAL_SHARE, joint_share
from armodal.analyzer.modal import (
    ModalModel,
    fit_modes,
    fit_modes_at,
    lines_within,
    proposed_band,
)
from armodal.protocols.errors import EstimateError, SessionError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.os_words import os_words
from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.session.records import Session

__all__ = [
    "OpenSession",
    "PostureView",
    "automatic_again",
    "fit_automatic",
    "fit_picked",
    "open_session",
    "opened_session",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureView:
    """One posture; without `model` until it is fitted, or when it cannot be: see `problem`."""

    frf: FrequencyResponse
    automatic: ModalModel | None = None
    model: ModalModel | None = None  # the automatic one, or the one from picked poles
    by_hand: bool = False
    picks: tuple[complex, ...] = ()  # poles rad/s the next refit starts from
    changed: bool = False  # picks differ from the model shown
    measured: MeasuredModes | None = None
    joint_share: tuple[float | None, ...] = ()
    problem: str = ""
    said: tuple[str, ...] = ()  # of its lines

    @property
    def name(self) -> str:
        """Name of the posture."""
        return self.frf.posture

    def structural(self, mode: int) -> bool:
        """Whether the joints leave a mode's motion unexplained."""
        share = self.joint_share[mode] if mode < len(self.joint_share) else None
        return share is not None and share < STRUCTURAL_SHARE

    def shape(self, mode: int) -> npt.NDArray[np.complex128] | None:
        """Shape (n_dofs,) of a mode along the measured directions."""
        return None if self.measured is None else self.measured.shapes[:, mode]


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenSession:
    """A session read and ready to be looked at."""

    path: Path
    session: Session
    superset: Superset
    views: tuple[PostureView, ...]
    band_hz: tuple[float, float] | None = None  # asked for

    @property
    def lost(self) -> str:
        """What the session lost, by kind: "lost 0", or "lost can 12, stream 3"; whose loss."""
        kinds = Counter[str]()
        for loss in self.session.losses:
            kinds[loss.kind] += loss.count
        whose = "" if self.session.header.time_scale == 1.0 or not kinds else "by the simulator "
        told = ", ".join(f"{kind} {n}" for kind, n in sorted(kinds.items())) or "0"
        return f"lost {whose}{told}"


def open_session(path: Path, *, band_hz: tuple[float, float] | None = None) -> OpenSession:
    """Read a session and estimate its FRFs; modes are fitted afterwards.

    Parameters
    ----------
    path
        Session file.
    band_hz
        Lines to look at; None for all.

    Raises
    ------
    SessionError
        If the file cannot be read or holds nothing to show.
    EstimateError
        If there are too few lines in the band.
    """
    try:
        session = read_session(path)
    except OSError as error:
        raise SessionError(f"{path}: {os_words(error)}; give the .h5 file of a session") from error
    return opened_session(path, session, band_hz=band_hz)


def opened_session(
    path: Path, session: Session, *, band_hz: tuple[float, float] | None = None
) -> OpenSession:
    """Make a session in memory ready to be looked at; `path` is where its files lie.

    Raises
    ------
    SessionError
        If it holds nothing to show.
    EstimateError
        If there are too few lines in the band.
    """
    superset = Superset(session.header.arm)
    frfs = estimate_frfs(session, superset, band_hz=band_hz)
    if not frfs:
        raise SessionError(
            f"{path}: wanted accepted hits or FRFs, the session has none yet; go on measuring with "
            "`armodal run`"
        )
    views = []
    for frf in frfs:
        band, said = proposed_band(frf) if band_hz is None else (band_hz, ())
        banded = frf if band is None else lines_within(frf, band)
        views.append(PostureView(frf=banded, said=said))
    return OpenSession(
        path=path,
        session=session,
        superset=superset,
        views=tuple(views),
        band_hz=band_hz,
    )


def fit_automatic(superset: Superset, view: PostureView) -> PostureView:
    """Fit a posture's modes; a posture that cannot be fitted says why."""
    try:
        model = fit_modes(view.frf)
    except EstimateError as error:
        return replace(view, problem=str(error))
    return automatic_again(superset, replace(view, automatic=model))


def automatic_again(superset: Superset, view: PostureView) -> PostureView:
    """A fitted posture with its automatic choice, whatever was picked since."""
    if view.automatic is None:
        raise ValueError(f"posture '{view.name}' has no automatic choice yet: fit it first")
    return replace(_with_model(superset, view, view.automatic), by_hand=False)


def fit_picked(superset: Superset, view: PostureView) -> PostureView:
    """Refit a posture from its picks.

    Raises
    ------
    EstimateError
        If the picks cannot be fitted; the view stays as it was.
    """
    if view.automatic is None:
        raise EstimateError(
            f"posture '{view.name}' is not fitted yet: wanted its poles over model orders first; "
            "wait for the fit"
        )
    model = fit_modes_at(view.frf, np.array(view.picks), view.automatic.stabilisation)
    return replace(_with_model(superset, view, model), by_hand=True)


def _with_model(superset: Superset, view: PostureView, model: ModalModel) -> PostureView:
    picks = tuple(mode.pole_rad_s for mode in model.modes)
    view = replace(view, model=model, picks=picks, changed=False, problem="")
    unknown = (None,) * len(model.modes)
    if view.frf.joints_rad is None:
        return replace(view, measured=None, joint_share=unknown)
    measured = MeasuredModes.of(superset, superset.posture(view.frf.joints_rad), model)
    if not superset.n_joints:
        return replace(view, measured=measured, joint_share=unknown)
    share = tuple(joint_share(superset, measured, shape) for shape in measured.shapes.T)
    return replace(view, measured=measured, joint_share=share)
