"""From a session to stiffness: FRFs, modes, model fit, axes, validation, in one pass."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.held import held_arm
from armodal.analyzer.identification.axis_results import axis_results
from armodal.analyzer.identification.beside_ordinary import BesideOrdinary
from armodal.analyzer.identification.beside_rows import (
    axes_beside,
    joints_beside,
    notes_beside,
)
from armodal.analyzer.identification.beside_validation import validation_beside
from armodal.analyzer.identification.chosen_model import choose_model, coarse_data
from armodal.analyzer.identification.estimate import estimate_frfs
from armodal.analyzer.identification.mode_fit import (
    MeasuredModes,
)
from armodal.analyzer.identification.model_error import model_error_std, model_moves
from armodal.analyzer.identification.prediction import predict_modes, roving_mass
from armodal.analyzer.identification.records import (
    Identification,
    ValidationResult,
)
from armodal.analyzer.identification.result_rows import (
    UNEXPLAINED,
    fit_notes,
    joint_results,
    mode_results,
    validation_results,
)
from armodal.analyzer.identification.structural import joint_share
from armodal.analyzer.modal import (
    ModalModel,
    fit_modes,
    fit_modes_at,
    lines_within,
    proposed_band,
    record_notes,
)
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session

__all__ = ["estimate_frfs", "identify"]

Array = npt.NDArray[np.float64]

_LOADED = (
    "left out, since a known mass is bolted on there, which `armodal identify` does not weigh; "
    "`armodal gap` does"
)
BAND_ABOVE = 1.5  # the model is fitted up to this multiple of the highest fitted mode


def identify(
    session: Session,
    progress: Callable[[str], None] | None = None,
    *,
    picked: Mapping[str, Sequence[complex]] | None = None,
    band_hz: tuple[float, float] | None = None,
) -> Identification:
    """Identify joint stiffness, damping and structural axes from a session.

    The model is fitted to the FRFs themselves. Modes say where that fit starts, how far up it
    goes, which motion the joints leave unexplained, and what is set beside the result. Postures
    marked for validation are predicted from the others before their modes are fitted.

    Parameters
    ----------
    session
        With accepted hits or FRFs.
    progress
        Told of every step.
    picked
        By posture, poles (rad/s) picked by hand that take the place of the automatic choice.
    band_hz
        Lines that modes and model are fitted to; by default modes to those that carry a signal.

    Raises
    ------
    EstimateError
        If the session holds no posture to fit, no joint of the arm is elastic, poles are picked
        for a posture without FRFs, or the fit fails.
    ArmError
        If an effect of the arm file cannot stay as it is while joints are fitted.
    """
    by_hand = dict(picked or {})
    say = progress or (lambda _: None)
    ready = held_arm(session.header.arm)
    superset = Superset(ready.arm)
    if not superset.n_joints:
        raise EstimateError(
            "the session is of a structure without an arm: joints cannot be identified; "
            "`armodal fit` gives its modes"
        )
    validation = {p.name for p in session.header.plan.postures if p.validation}
    say("FRFs")
    frfs = estimate_frfs(session, superset, band_hz=band_hz)
    if band_hz is not None:
        frfs = tuple(lines_within(frf, band_hz) for frf in frfs)
    loaded = {p.name for p in session.header.plan.postures if p.known_mass is not None}
    left_out = [frf.posture for frf in frfs if frf.posture in loaded]
    frfs = tuple(frf for frf in frfs if frf.posture not in loaded)
    fitted = tuple(frf for frf in frfs if frf.posture not in validation)
    held_out = tuple(frf for frf in frfs if frf.posture in validation)
    if not fitted:
        raise EstimateError(
            "wanted at least one posture with accepted hits that is not for validation and has no "
            "known mass bolted on; the session has none; measure one"
        )
    unknown = by_hand.keys() - {frf.posture for frf in frfs}
    if unknown:
        raise EstimateError(
            f"wanted picked poles of {', '.join(frf.posture for frf in frfs)}, got poles of "
            f"{', '.join(sorted(unknown))}; pick again in `armodal review`"
        )
    say("modes")
    proposed = {frf.posture: proposed_band(frf) for frf in frfs} if band_hz is None else {}
    bands = {name: band for name, (band, _) in proposed.items()}
    models = tuple(_modes(frf, by_hand.get(frf.posture), bands) for frf in fitted)
    measured = _measured(superset, fitted, models)
    if not any(model.modes for model in models):
        raise EstimateError(
            "no posture shows a mode: nothing can be identified; look at the FRFs with "
            "`armodal fit`, and hit harder or nearer to where the arm moves"
        )
    shares = [[joint_share(superset, m, shape) for shape in m.shapes.T] for m in measured]
    mass_kg = session.header.plan.sensor.mass_kg
    top_hz = BAND_ABOVE * max(mode.f_hz for model in models for mode in model.modes)
    banded = [lines_within(frf, (float(frf.freq_hz[0]), top_hz)) for frf in fitted]
    chosen = choose_model(session, superset, ready, banded, measured, shares, say)
    fit, beside = chosen.fit, chosen.beside
    say("uncertainty")
    moves = model_moves(superset, coarse_data(superset, banded, mass_kg), fit)
    model_std = model_error_std(moves)
    say("prediction")
    predictions = [
        predict_modes(
            superset,
            superset.posture(_angles(frf)),
            fit,
            added_mass_kg=roving_mass(superset, frf, mass_kg),
        )
        for frf in frfs
    ]
    held_out_models = tuple(_modes(frf, by_hand.get(frf.posture), bands) for frf in held_out)
    checked = _measured(superset, held_out, held_out_models)
    foretold = [
        _foretold(beside, session, *of) for of in zip(held_out, held_out_models, strict=True)
    ]
    by_posture = {frf.posture: p for frf, p in zip(frfs, predictions, strict=True)}
    fit_predictions = [by_posture[frf.posture] for frf in fitted]
    # Where the joints alone explain the motion, a low share is the sensor's mass or noise.
    beyond_joints = bool(fit.state.structure.axes or fit.relative_residual.max() >= UNEXPLAINED)
    return Identification(
        joints=joints_beside(
            joint_results(superset, fit, model_std, fitted, measured, fit_predictions), beside
        ),
        axes=axes_beside(
            axis_results(superset, fit, model_std, fitted, measured, shares, fit_predictions),
            beside,
        ),
        explained_by=chosen.explained,
        modes=mode_results(fitted, measured, shares, fit_predictions, beyond_joints),
        validation=tuple(
            result
            for frf, m, (own, _) in zip(held_out, checked, foretold, strict=True)
            for result in (
                validation_results(frf, m, by_posture[frf.posture]) if own is None else own
            )
        ),
        rivals=chosen.rivals,
        fit=fit,
        model_moves=moves,
        modal_models=models + held_out_models,
        frfs=fitted + held_out,
        notes=(
            *(f"posture {name}: modes from poles picked by hand" for name in by_hand),
            *(f"posture {name}: {_LOADED}" for name in left_out),
            *(note for _, notes in foretold for note in notes),
            *ready.notes,
            *chosen.notes,
            *(note for _, said in proposed.values() for note in said),
            *(
                note
                for frf in frfs
                for note in record_notes(session, frf.posture, band_hz=band_hz, board_limits=False)
            ),
            *fit_notes(fit, fitted, shares, notes_beside(chosen.explained, beside)),
        ),
    )


def _foretold(
    beside: BesideOrdinary | None, session: Session, frf: FrequencyResponse, own: ModalModel
) -> tuple[list[ValidationResult] | None, tuple[str, ...]]:
    """Modes foretold beside what is ordinary; None where joints alone have to, and why they do."""
    if beside is None:
        return None, ()
    try:
        return validation_beside(beside, session, frf, own), ()
    except EstimateError as problem:
        return None, (f"posture {frf.posture}: foretold by joints alone, since {problem}",)


def _modes(
    frf: FrequencyResponse,
    picked: Sequence[complex] | None,
    bands: Mapping[str, tuple[float, float] | None],
) -> ModalModel:
    automatic = fit_modes(frf, band_hz=bands.get(frf.posture))
    if picked is None:
        return automatic
    return fit_modes_at(frf, np.array(picked), automatic.stabilisation)


def _measured(
    superset: Superset, frfs: tuple[FrequencyResponse, ...], models: tuple[ModalModel, ...]
) -> list[MeasuredModes]:
    return [
        MeasuredModes.of(superset, superset.posture(_angles(frf)), model)
        for frf, model in zip(frfs, models, strict=True)
    ]


def _angles(frf: FrequencyResponse) -> Array:
    if frf.joints_rad is None:
        raise EstimateError(
            f"posture '{frf.posture}' has no measured joint angles: no model can be set beside it"
        )
    return frf.joints_rad
