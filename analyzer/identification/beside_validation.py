"""Modes of a posture that was not fitted, foretold by joints beside what gives way ordinarily."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.compare import match_modes, poles_and_shapes
from armodal.analyzer.gap.inference.fit import Fit
from armodal.analyzer.gap.model.lines import Annealing, PostureLines, own_lines, shifted_lines
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.gap.model.system import System
from armodal.analyzer.identification.beside_ordinary import BesideOrdinary
from armodal.analyzer.identification.records import ValidationResult
from armodal.analyzer.modal import ModalModel
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session

__all__ = ["validation_beside"]

ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_DRAWS = 48  # of the fit's parameters: a deviation to a tenth of itself


def validation_beside(
    beside: BesideOrdinary, session: Session, frf: FrequencyResponse, measured: ModalModel
) -> list[ValidationResult]:
    """Foretell the modes of a posture below the fitted lines' end, beside measured ones.

    The sensor's mass is shared among the points it was mounted on.

    Raises
    ------
    EstimateError
        If the posture's records have no lines in the fitted band, or a point lacks an axis.
    """
    lines = _lines(beside, session, frf)
    known = beside.fit.values | {f"aim {side} {lines.name}": 0.0 for side in "ab"}
    model = PosedModel(beside.fit.hypothesis.ordinary.superset, lines.joints_rad)

    def system(values: dict[str, float]) -> System:
        found = model.system(beside.fit.hypothesis, lines, known | values)
        rows = found.moved.reshape(-1, found.mass.shape[0])
        shared = lines.sensor_mass_kg / len(found.moved)
        return replace(found, mass=found.mass + shared * rows.T @ rows)

    base = system({})
    poles = poles_and_shapes(base)[0]
    end = float(beside.stages[-1].lines[0].s_rad_s[-1].imag)
    poles = poles[np.abs(poles) < end]
    drawn = [_followed(poles, poles_and_shapes(system(v))[0]) for v in _draws(beside)]
    f_std, damping_std = (np.std(of(np.array(drawn)), axis=0, ddof=1) for of in (_hz, _ratio))
    points = [point.id for point in beside.fit.hypothesis.ordinary.arm.points]
    pairs = {match.model_hz: match for match in match_modes(measured, base, lines, points)}
    by_f = {mode.f_hz: mode for mode in measured.modes}
    results = []
    for i, (f_hz, ratio) in enumerate(zip(_hz(poles), _ratio(poles), strict=True)):
        match = next((m for hz, m in pairs.items() if np.isclose(hz, f_hz, rtol=1e-9)), None)
        mode = None if match is None else by_f[min(by_f, key=lambda f: abs(f - match.measured_hz))]
        results.append(
            ValidationResult(
                posture=frf.posture,
                mode=i + 1,
                predicted_hz=float(f_hz),
                predicted_std_hz=float(f_std[i]),
                predicted_dof=_DRAWS - 1.0,
                predicted_damping=float(ratio),
                predicted_damping_std=float(damping_std[i]),
                measured_hz=None if mode is None else mode.f_hz,
                measured_std_hz=None if mode is None else mode.f_std_hz,
                measured_dof=None if mode is None else mode.dof,
                measured_damping=None if mode is None else mode.damping_ratio,
                measured_damping_std=None if mode is None else mode.damping_std,
                mac=None if match is None else match.mac,
            )
        )
    return results


def _lines(beside: BesideOrdinary, session: Session, frf: FrequencyResponse) -> PostureLines:
    """Some lines of the posture: they tell where its sensors and hits were."""
    superset = beside.fit.hypothesis.ordinary.superset
    s = beside.stages[0].lines[0].s_rad_s
    band = (float(s[0].imag) / (2.0 * np.pi), float(s[-1].imag) / (2.0 * np.pi))
    few = Annealing(sigma_rad_s=float(s[0].real), step_hz=band[1] - band[0], band_hz=band)
    hits = tuple(hit for hit in session.hits if hit.posture == frf.posture)
    if hits:
        (lines,) = own_lines(superset, replace(session, hits=hits), few)
    else:
        mass = session.header.plan.sensor.mass_kg
        (lines,) = shifted_lines(superset, [frf], few, sensor_mass_kg=mass)
    return lines


def _draws(beside: BesideOrdinary) -> list[dict[str, float]]:
    """Values of the parameters as the fit leaves them open, within their bounds."""
    fit: Fit = beside.fit
    rng = np.random.default_rng(0)
    free = np.flatnonzero(fit.free)
    covariance = fit.covariance(beside.inflation)[np.ix_(free, free)]
    moves = rng.multivariate_normal(np.zeros(free.size), covariance, _DRAWS, method="cholesky")
    found = []
    for move in moves:
        u = fit.u.copy()
        u[free] += move
        found.append(fit.space.values(np.clip(u, fit.space.low, fit.space.high)))
    return found


def _followed(poles: ComplexArray, others: ComplexArray) -> ComplexArray:
    """Of other poles the nearest to each."""
    return np.asarray(others[np.argmin(np.abs(others[None] - poles[:, None]), axis=1)])


def _hz(poles: ComplexArray) -> npt.NDArray[np.float64]:
    return np.asarray(np.abs(poles) / (2.0 * np.pi))


def _ratio(poles: ComplexArray) -> npt.NDArray[np.float64]:
    return np.asarray(-poles.real / np.abs(poles))
