"""Where a compliance axis may sit: starts from measured modes, judged by the FRFs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.reduced import model_modes, reduce_model
from armodal.analyzer.arm.structure import Axis, Structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.frf_fit import FrfFit, fit_frfs
from armodal.analyzer.identification.frf_model import PostureData
from armodal.analyzer.identification.mode_fit import MeasuredModes, fit_to_frequencies
from armodal.analyzer.identification.parameters import FitState
from armodal.analyzer.identification.structural import moment_about, mozzi_of_shape, to_link
from armodal.protocols.errors import EstimateError

__all__ = ["best_axis_fit", "start_state", "why_no_axis"]

START_DAMPING_RATIO = 0.03


def start_state(structure: Structure, n_postures: int) -> FitState:
    """Return a structure with every nuisance at its prior's mean."""
    return FitState(
        structure=structure, log_gain=np.zeros(3), hit_tilt_rad=np.zeros((n_postures, 2))
    )


def why_no_axis(
    superset: Superset, structure: Structure, data: tuple[PostureData, ...]
) -> str | None:
    """Why a fitted axis is none, or None: what does not swing is no compliance."""
    for posture in data:
        try:
            model_modes(reduce_model(superset, posture.dynamics, structure))
        except EstimateError as problem:
            return f"an axis was looked for and left out: {problem}"
    return None


def axis_starts(
    superset: Superset, measured: MeasuredModes, mode: int, link: int
) -> tuple[Axis, ...]:
    """Axes to start from: the mode's Mozzi axis, and the link's own directions at its middle."""
    omega = 2 * np.pi * measured.modes[mode].f_hz
    lines: list[tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]] = []
    with suppress(EstimateError):  # too few points beyond the link: the link's directions remain
        mozzi = mozzi_of_shape(superset, measured, measured.shapes[:, mode], link)
        if mozzi is not None:
            lines.append(to_link(measured.dynamics, link, mozzi))
    joint = superset.arm.joints[link]
    center = joint.link.center_m
    lines += [
        (direction, center - direction * (direction @ center))
        for direction in np.eye(3)
        # An elastic joint's own axis cannot be told from the joint.
        if joint.stiffness is None or abs(direction @ joint.axis) < 0.9
    ]
    starts = []
    for direction, point in lines:
        axis = Axis(
            link=link,
            direction=direction,
            point_m=point,
            stiffness_n_m_per_rad=1.0,
            damping_n_m_s_per_rad=1.0,
        )
        k = omega**2 * moment_about(superset, measured.dynamics, axis)
        c = 2 * START_DAMPING_RATIO * k / omega
        starts.append(replace(axis, stiffness_n_m_per_rad=k, damping_n_m_s_per_rad=c))
    return tuple(starts)


def best_axis_fit(
    superset: Superset,
    baseline: Structure,
    postures: tuple[PostureData, ...],
    measured: Sequence[MeasuredModes],
    flagged: tuple[int, int],
    progress: Callable[[str], None],
) -> tuple[FrfFit, tuple[tuple[str, float], ...]]:
    """Release one axis, in each link in turn, and keep the fit with the smallest cost.

    Parameters
    ----------
    flagged
        (posture, mode) of the structural mode to start from.

    Returns
    -------
    fit, rivals
        The best fit, and (link, cost) of the best fit in every link tried, or of where it was
        given up.

    Raises
    ------
    EstimateError
        If no start converges.
    """
    at, mode = flagged
    best: FrfFit | None = None
    rivals: list[tuple[str, float]] = []
    # Beyond the last elastic joint a compliance and the inertia behind it lie above the band.
    for link in range(max(baseline.joints) + 1):
        name = superset.arm.joints[link].link.name
        costs = []
        for axis in axis_starts(superset, measured[at], mode, link):
            try:
                structure = fit_to_frequencies(
                    superset, replace(baseline, axes=(axis,)), tuple(measured)
                )
                start = start_state(structure, len(postures))
                beaten = np.inf if best is None else best.cost
                fit = fit_frfs(superset, postures, start, beaten=beaten)
            except (EstimateError, np.linalg.LinAlgError):
                continue
            costs.append(fit.cost)
            progress(f"an axis tried in {name}: misfit {fit.cost:.4g}")
            if best is None or fit.cost < best.cost:
                best = fit
        if costs:
            rivals.append((name, min(costs)))
    if best is None:
        raise EstimateError(
            "no compliance axis could be fitted to the FRFs; measure the structural mode in more "
            "postures, or with a hit that excites it more"
        )
    return best, tuple(rivals)
