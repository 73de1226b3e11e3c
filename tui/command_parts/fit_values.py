"""Modes of every posture of a session, for `armodal fit`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.analyzer.identification.structural import STRUCTURAL_SHARE, joint_share
from armodal.analyzer.modal import (
    MassScaling,
    ModalModel,
    band_of_hits,
    drift_told,
    fit_modes,
    hit_choices,
    mass_scaling,
    missing_mode_hints,
    proposed_band,
    real_modes,
    record_notes,
    stable_poles,
    typical_random_errors,
)
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session
from armodal.tui.command_parts.fit_settings import FitSettings
from armodal.tui.console import working
from armodal.tui.json_text import plain

__all__ = ["fit_values"]


def fit_values(session: Session, settings: FitSettings) -> dict[str, Any]:
    """Fit the modes of every posture; return them as plain values.

    Raises
    ------
    EstimateError
        If the session has neither hits nor FRFs, or FRFs cannot be fitted.
    """
    session = settings.applied_to(session)
    superset = Superset(session.header.arm)
    frfs = estimate_frfs(session, superset, band_hz=settings.band_hz)
    if not frfs:
        raise EstimateError(
            "the session has no accepted hits and no FRFs: there is nothing to fit; measure first"
        )
    given = {frf.posture for frf in session.frfs}
    modes: list[dict[str, Any]] = []
    errors: dict[str, float] = {}
    stabilisation: dict[str, Any] = {}
    postures: dict[str, Any] = {}
    warnings = list(session.warnings)
    for frf in frfs:
        band = settings.band_hz
        if band is None:
            band, said = proposed_band(frf)
            warnings += said
        with working(f"posture {frf.posture!r}") as tell:
            model = fit_modes(frf, band_hz=band, max_order=settings.max_order, tell=tell)
        errors[frf.posture] = model.synthesis_error
        stabilisation[frf.posture] = _stabilisation(model)
        modes += _modes(superset, frf, model)
        warnings += record_notes(
            session,
            frf.posture,
            band_hz=settings.band_hz,
            ends_earlier=model.band_hz[1] < frf.freq_hz[-1],
        )
        warnings += [f"posture {frf.posture!r}: {note}" for note in model.notes]
        averaged_here = frf.posture not in given
        if settings.about_hits() and not averaged_here:
            warnings.append(
                f"posture {frf.posture!r}: its FRFs were averaged elsewhere: windows, estimator "
                "and hits kept are theirs, not those asked for"
            )
        postures[frf.posture] = _posture(session, frf, model, averaged_here=averaged_here)
    found: dict[str, Any] = {
        "modes": modes,
        "synthesis_error": errors,
        "stabilisation": stabilisation,
        "postures": postures,
        "warnings": warnings,
    }
    values: dict[str, Any] = plain(found)
    return values


def _modes(superset: Superset, frf: FrequencyResponse, model: ModalModel) -> list[dict[str, Any]]:
    shares = _joint_shares(superset, frf, model)
    scaling = _scaling(model)
    shapes = _shapes(model)
    return [
        {
            "posture": frf.posture,
            "f_hz": mode.f_hz,
            "f_std_hz": mode.f_std_hz,
            "damping_ratio": mode.damping_ratio,
            "damping_std": mode.damping_std,
            "dof": mode.dof,
            "mpc": mode.mpc,
            "mpd_deg": mode.mpd_deg,
            "mcf": mode.mcf,
            # Without an arm, or its angles, nobody can tell what is structural.
            "structural": None if share is None else share < STRUCTURAL_SHARE,
            "joint_share": share,
            "modal_mass_kg": None if scaled is None else scaled.modal_mass_kg,
            "modal_mass_std_kg": None if scaled is None else scaled.modal_mass_std_kg,
            "shape": shape,
        }
        for mode, share, scaled, shape in zip(model.modes, shares, scaling, shapes, strict=True)
    ]


def _joint_shares(
    superset: Superset, frf: FrequencyResponse, model: ModalModel
) -> Sequence[float | None]:
    """Share of each shape that joints explain; None without an arm or its angles."""
    if frf.joints_rad is None or not superset.n_joints:
        return [None] * len(model.modes)
    measured = MeasuredModes.of(superset, superset.posture(frf.joints_rad), model)
    return [joint_share(superset, measured, shape) for shape in measured.shapes.T]


def _scaling(model: ModalModel) -> Sequence[MassScaling | None]:
    """Modal masses where a driving point tells them."""
    try:
        return mass_scaling(model)
    except EstimateError:
        return [None] * len(model.modes)


def _shapes(model: ModalModel) -> list[list[dict[str, Any]]]:
    """Shapes where they were measured at more places: at the responses, or where the hammer went.

    `real` is the entry of the nearest real mode, None where there are fewer places than modes.
    """
    hammer = len(model.references) > len(model.responses)
    dofs = model.references if hammer else model.responses
    values = [mode.participation if hammer else mode.shape for mode in model.modes]
    std = [mode.participation_std if hammer else mode.shape_std for mode in model.modes]
    nearest: npt.NDArray[np.float64] | None = None
    if values:
        try:
            nearest = real_modes(np.stack(values, axis=1)).T
        except EstimateError:
            nearest = None
    return [
        [
            {
                "point": dof.point,
                "label": dof.label,
                "re": float(value.real),
                "im": float(value.imag),
                "re_std": float(wide.real),
                "im_std": float(wide.imag),
                "real": None if nearest is None else float(nearest[m, i]),
            }
            for i, (dof, value, wide) in enumerate(zip(dofs, values[m], std[m], strict=True))
        ]
        for m in range(len(model.modes))
    ]


def _posture(
    session: Session, frf: FrequencyResponse, model: ModalModel, *, averaged_here: bool
) -> dict[str, Any]:
    """How the FRFs were made, how well the model repeats them, what may be missing."""
    plan = session.header.plan
    choices = hit_choices(session, frf.posture) if averaged_here else ()
    errors = typical_random_errors(frf)
    usable = band_of_hits(session, frf.posture)
    return {
        "form": str(frf.form),
        "lines": len(frf.freq_hz),
        "estimator": str(plan.averaging.estimator) if averaged_here else None,
        "exponential_end": plan.windows.exponential_end if averaged_here else None,
        "force_s": plan.windows.force_s if averaged_here else None,
        "window_decay_rad_s": frf.decay_rad_s,
        "window": _said_of_window(frf),
        "usable_band_hz": None if usable is None else [usable.low_hz, usable.high_hz],
        "hits_dropped": [
            {
                "hit": hit.hit,
                "sensor_point": choice.sensor_point,
                "hit_point": choice.reference.point,
                "reason": hit.reason,
                "p_value": hit.p_value,
                "note": hit.note,
            }
            for choice in choices
            for hit in choice.dropped
        ],
        "random_error": dict(zip(("from_scatter", "from_coherence"), errors, strict=True)),
        "lack_of_fit": model.lack_of_fit,
        "frfs": [
            {
                "response": f"{response.point} {response.label}",
                "reference": f"{reference.point} {reference.label}",
                "synthesis_error": float(model.frf_error[i, j]),
                "frac": float(model.frac[i, j]),
            }
            for i, response in enumerate(model.responses)
            for j, reference in enumerate(model.references)
        ],
        "drift": [asdict(told) for told in drift_told(model)],
        "missing_mode_hints": [
            {
                "f_hz": hint.f_hz,
                "misfit_ratio": hint.ratio,
                "misfit_share": hint.share,
                "beside_hz": hint.beside_hz,
            }
            for hint in missing_mode_hints(frf, model)
        ],
    }


def _said_of_window(frf: FrequencyResponse) -> str:
    if frf.decay_rad_s <= 0.0:
        return "no exponential window"
    return (
        f"the same exponential window e^(-{frf.decay_rad_s:.4g} t) on force and response, which "
        "adds no damping: poles are fitted on s = decay + j w"
    )


def _stabilisation(model: ModalModel) -> dict[str, Any]:
    """Poles over model orders, as plain values."""
    found = model.stabilisation
    f_hz, damping, stable = found.f_hz, found.damping_ratio, stable_poles(found)
    return {
        "band_hz": list(model.band_hz),
        "orders": list(found.orders),
        "poles": [
            {
                "order": int(order),
                "f_hz": float(f),
                "damping_ratio": float(ratio),
                "stable": bool(same),
            }
            for order, f, ratio, same in zip(found.order, f_hz, damping, stable, strict=True)
        ],
    }
