"""Which model a session is fitted with: joints alone, an axis too, what is ordinary beside them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from armodal.analyzer.arm.structure import Axis, Structure, believed_structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.held import HeldArm
from armodal.analyzer.gap.decision.calibration import FALSE_NAME
from armodal.analyzer.identification.axis_search import best_axis_fit, start_state, why_no_axis
from armodal.analyzer.identification.beside_ordinary import BesideOrdinary, fit_beside_ordinary
from armodal.analyzer.identification.frf_fit import FrfFit, fit_frfs
from armodal.analyzer.identification.frf_model import PostureData, posture_data
from armodal.analyzer.identification.mode_fit import MeasuredModes, fit_to_frequencies
from armodal.analyzer.identification.parameters import FitState
from armodal.analyzer.identification.records import Explained
from armodal.analyzer.identification.result_rows import UNEXPLAINED
from armodal.analyzer.identification.structural import STRUCTURAL_SHARE
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session

__all__ = ["ChosenModel", "choose_model", "coarse_data"]

SEARCH_STRIDE = 4  # lines skipped while axes are searched
_NO_AXIS = (
    "no structural axis was sought: beside all that may be off in any sound arm nothing speaks for "
    "one"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ChosenModel:
    """The fits of a session."""

    fit: FrfFit  # joints and axes alone
    beside: BesideOrdinary | None = None  # where these leave much
    rivals: tuple[tuple[str, float], ...] = ()  # where an axis was tried, and the cost there
    notes: tuple[str, ...] = ()
    explained: Explained = Explained.JOINTS


def coarse_data(
    superset: Superset, frfs: Sequence[FrequencyResponse], mass_kg: float
) -> tuple[PostureData, ...]:
    """Return some lines of every posture, for searches."""
    return _data(superset, frfs, mass_kg, SEARCH_STRIDE)


def choose_model(
    session: Session,
    superset: Superset,
    ready: HeldArm,
    frfs: Sequence[FrequencyResponse],
    measured: Sequence[MeasuredModes],
    shares: Sequence[Sequence[float]],
    say: Callable[[str], None],
) -> ChosenModel:
    """Fit joints alone; where they leave much, what is ordinary beside them, and an axis if any.

    Parameters
    ----------
    superset, ready
        Of the session's arm with the bodies of its effects.
    frfs, measured, shares
        Of the fitted postures; shares of the joints in their modes.

    Raises
    ------
    EstimateError
        If no joint is elastic, or a fit fails.
    """
    believed = replace(believed_structure(superset.arm), axes=ready.axes, held=ready.held)
    if not believed.joints:
        raise EstimateError(
            f"arm '{superset.arm.name}' has no elastic joint: give at least one a stiffness in "
            "the arm file"
        )
    mass_kg = session.header.plan.sensor.mass_kg
    baseline = fit_to_frequencies(superset, believed, tuple(measured))
    full = _data(superset, frfs, mass_kg, 1)
    coarse = coarse_data(superset, frfs, mass_kg)

    def fitted(structure: Structure, state: FitState | None = None) -> FrfFit:
        say("model fit, all lines")
        return fit_frfs(superset, full, state or start_state(structure, len(full)))

    # Axes that the arm file has are fitted, no further one is looked for.
    if believed.axes or _explained_by_joints(superset, baseline, coarse):
        fit = fitted(baseline)
        if _is_explained(fit):
            return ChosenModel(fit=fit)
        return _chosen(fit, *_beside(session, frfs, say))
    beside, notes = _beside(session, frfs, say)
    if not any(share < STRUCTURAL_SHARE for posture in shares for share in posture):
        return _chosen(fitted(baseline), beside, notes)
    if beside is not None and not beside.may_have_axis():
        return _chosen(fitted(baseline), beside, (_NO_AXIS,))
    rivals: tuple[tuple[str, float], ...] = ()
    try:
        best, rivals = best_axis_fit(superset, baseline, coarse, measured, _least(shares), say)
        fit = fitted(best.state.structure, best.state)
        why = why_no_axis(superset, fit.state.structure, full)
        if why is None and beside is not None:
            (axis,) = fit.state.structure.axes
            richer, why = _with_axis(superset, beside, axis)
            beside = beside if why is not None else richer
        if why is None:
            return _chosen(fit, beside, notes, rivals)
    except EstimateError as problem:
        # What the joints leave need not be an axis.
        why = f"joints alone leave much, but no axis in a link explains it: {problem}"
    return _chosen(fitted(baseline), beside, (*notes, why), rivals)


def _chosen(
    fit: FrfFit,
    beside: BesideOrdinary | None,
    notes: tuple[str, ...],
    rivals: tuple[tuple[str, float], ...] = (),
) -> ChosenModel:
    """What is ordinary stands beside joints and axes where they leave much and it tells more."""
    if _is_explained(fit):
        return ChosenModel(fit=fit, rivals=rivals, notes=notes)
    if beside is None:
        return ChosenModel(fit=fit, rivals=rivals, notes=notes, explained=Explained.NOTHING)
    beside = beside.settled()
    needed = beside.is_needed()
    explained = Explained.ORDINARY if needed else Explained.JOINTS
    if beside.lacks_an_effect:
        explained = Explained.NOTHING
    return ChosenModel(
        fit=fit,
        beside=beside if needed else None,
        rivals=rivals,
        notes=notes,
        explained=explained,
    )


def _beside(
    session: Session, frfs: Sequence[FrequencyResponse], say: Callable[[str], None]
) -> tuple[BesideOrdinary | None, tuple[str, ...]]:
    """What is ordinary beside the joints, or why it cannot be told."""
    say("bearings, links and base beside the joints")
    try:
        return fit_beside_ordinary(session, tuple(frfs)), ()
    except EstimateError as problem:
        why = (
            "k is that of joints alone, since what bearings, links and base give way beside them "
            f"cannot be told: {problem}"
        )
        return None, (why,)


def _with_axis(
    superset: Superset, beside: BesideOrdinary, axis: Axis
) -> tuple[BesideOrdinary, str | None]:
    """The fit with an axis too, and why the axis is none."""
    richer = beside.with_axis(axis)
    if beside.fit.evidence - richer.fit.evidence > beside.axis_limit_nats(richer):
        return richer, None
    link = superset.arm.joints[axis.link].link.name
    return richer, (
        f"an axis in {link} was looked for and left out: beside bearings, links and base that "
        "give way in any sound arm it explains no more than chance does in "
        f"{FALSE_NAME:.0%} of sound sessions"
    )


def _least(shares: Sequence[Sequence[float]]) -> tuple[int, int]:
    """Posture and mode with the least share of the joints."""
    _, at, mode = min(
        (share, at, mode) for at, posture in enumerate(shares) for mode, share in enumerate(posture)
    )
    return at, mode


def _is_explained(fit: FrfFit) -> bool:
    return bool(fit.relative_residual.max() < UNEXPLAINED)


def _explained_by_joints(
    superset: Superset, baseline: Structure, data: tuple[PostureData, ...]
) -> bool:
    try:
        return _is_explained(fit_frfs(superset, data, start_state(baseline, len(data))))
    except EstimateError:
        return False


def _data(
    superset: Superset, frfs: Sequence[FrequencyResponse], mass_kg: float, stride: int
) -> tuple[PostureData, ...]:
    return tuple(posture_data(superset, frf, sensor_mass_kg=mass_kg, stride=stride) for frf in frfs)
