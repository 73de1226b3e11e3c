"""A model beside one posture's measurement: FRFs, modes, and a map of where they disagree."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.linalg

from armodal.analyzer.arm.hysteresis import (
    hysteresis,
    lost_by_power,
    lost_by_power_slope_of_line,
    relaxed,
    relaxed_slope_of_line,
)
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.system import System
from armodal.analyzer.gap.records import Disagreement, ModeMatch, PostureGap
from armodal.analyzer.modal.correlation import mac
from armodal.analyzer.modal.modes import ModalModel

__all__ = ["disagreement_map", "match_modes", "poles_and_shapes", "posture_gap"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_BANDS = 3
_NEWTON_STEPS = 4
_LEAST_MAC = 0.6
_FASTEST = 2.0 * np.pi * 1e5  # rad/s: beyond, a pole is rounding
_NEAR = 0.25  # of the frequency: modes further apart are not one


def posture_gap(
    stage: Stage,
    fit: Fit,
    posture: int,
    *,
    held_out: bool,
    measured: ModalModel | None = None,
) -> PostureGap:
    """Difference of FRFs, best mounting errors taken off, and modes paired by shape.

    `fit` is the model; on a held-out posture it must not have seen it.
    """
    lines, weighing = stage.lines[posture], stage.weighings[posture]
    model = stage.models[posture]
    left = weighing.cleaned(model.values(fit.hypothesis, lines, fit.values)) / weighing.scale
    size = float(np.sqrt(np.mean(np.abs(lines.values) ** 2)))
    allowed = float(np.sqrt(np.mean(2.0 / weighing.scale**2)))
    modes = (
        ()
        if measured is None
        else match_modes(
            measured,
            model.system(fit.hypothesis, lines, fit.values),
            lines,
            [point.id for point in fit.hypothesis.ordinary.arm.points],
        )
    )
    return PostureGap(
        posture=lines.title,
        held_out=held_out,
        frf_error=float(np.sqrt(np.mean(np.abs(left) ** 2))) / size,
        floor=allowed / size,
        modes=modes,
    )


def match_modes(
    measured: ModalModel, system: System, lines: PostureLines, points: Sequence[str]
) -> tuple[ModeMatch, ...]:
    """Return measured modes beside the model's, each model mode used once, best MAC first.

    Close modes are compared as a subspace: a measured shape is set beside its projection on the
    model's shapes within the band around it.

    Parameters
    ----------
    lines, points
        Of the posture, which say where it was measured; ids of the arm's points, in order.
    """
    poles, shapes = poles_and_shapes(system)
    poles = poles - system.decay_rad_s  # records that fall by themselves have poles further left
    measured_shapes, rows = _where_measured(measured, system, lines, points)
    seen = rows @ shapes
    pairs = []
    for i, (mode, shape) in enumerate(zip(measured.modes, measured_shapes, strict=True)):
        f = abs(mode.pole_rad_s) / (2.0 * np.pi)
        near = np.flatnonzero(np.abs(np.abs(poles) / (2.0 * np.pi) - f) < _NEAR * f)
        if near.size == 0:
            continue
        basis = seen[:, near]
        projected = basis @ np.linalg.lstsq(basis, shape, rcond=None)[0]
        share = mac(shape, projected)
        each = [mac(shape, seen[:, j]) for j in near]
        best = int(near[int(np.argmax(each))])
        if share >= _LEAST_MAC:
            pairs.append((share, i, best))
    used: set[int] = set()
    found = []
    for share, i, j in sorted(pairs, reverse=True):
        if j in used:
            continue
        used.add(j)
        p, q = measured.modes[i].pole_rad_s, poles[j]
        found.append(
            ModeMatch(
                measured_hz=float(abs(p) / (2.0 * np.pi)),
                model_hz=float(abs(q) / (2.0 * np.pi)),
                measured_damping_ratio=float(-p.real / abs(p)),
                model_damping_ratio=float(-q.real / abs(q)),
                mac=float(share),
            )
        )
    return tuple(sorted(found, key=lambda m: m.measured_hz))


def _where_measured(
    measured: ModalModel, system: System, lines: PostureLines, points: Sequence[str]
) -> tuple[list[ComplexArray], Array]:
    """Shapes (n_dofs,) of the measured modes, and the motion (n_dofs, n) there of each coordinate.

    With a roving hammer that is where it hit: by reciprocity a mode's participation is its shape
    along the hits.
    """
    if lines.hammer_roves:
        dofs, at, motion = measured.references, lines.hit_point, system.hit
        all_shapes = [np.asarray(mode.participation) for mode in measured.modes]
    else:
        dofs, at, motion = measured.responses, lines.sensor_point, system.moved
        all_shapes = [np.asarray(mode.shape) for mode in measured.modes]
    motion_of = {points[p]: own for p, own in zip(at.tolist(), motion, strict=True)}
    known = [i for i, dof in enumerate(dofs) if dof.point in motion_of]
    rows = [dofs[i].direction @ motion_of[dofs[i].point] for i in known]
    return [shape[known] for shape in all_shapes], np.array(rows).reshape(len(rows), -1)


def poles_and_shapes(system: System) -> tuple[ComplexArray, ComplexArray]:
    """Return poles (k,) of positive frequency and shapes (n, k) of the coordinates."""
    n = system.mass.shape[0]
    soft = np.isfinite(system.compliance)
    free = np.flatnonzero(~soft | (system.compliance > 1e-9))
    K = system.stiffness[np.ix_(free, free)].astype(np.complex128)
    loss = system.loss[np.ix_(free, free)]
    C = system.damping[np.ix_(free, free)].astype(np.complex128)
    for at, i in enumerate(free):
        if soft[i]:
            K[at, at] += 1.0 / system.compliance[i]
            C[at, at] += system.compliance_loss_s[i] / system.compliance[i]
            loss[at, at] += system.compliance_loss_factor[i] / system.compliance[i]
    K += 1j * loss
    M = system.mass[np.ix_(free, free)]
    m = len(free)
    # Two coordinates may move the arm alike, such as a floor's and an upright joint's turn: of the
    # pencil their difference has no mass and no finite pole.
    none, one = np.zeros((m, m)), np.eye(m)
    state = np.block([[none, one], [-K, -C]])
    values, vectors = scipy.linalg.eig(state, np.block([[one, none], [none, M]]))
    keep = np.flatnonzero(np.isfinite(values) & (values.imag > 0.0) & (np.abs(values) < _FASTEST))
    shapes = np.zeros((n, keep.size), dtype=np.complex128)
    shapes[free] = vectors[:m, keep]
    poles = values[keep]
    if loss.any() or system.relaxing.any():
        drives = system.loss[np.ix_(free, free)]
        relaxing = [of[np.ix_(free, free)] for of in system.relaxing]
        still = (M, C, K - 1j * loss, drives, loss - drives, *relaxing)
        v = vectors[:m, keep]
        modal = [np.einsum("ij,ik,kj->j", v, of, v) for of in still]
        poles = _with_losses(
            poles, *modal, power=system.loss_power, rates_rad_s=system.relaxing_rad_s
        )
    order = np.argsort(np.abs(poles))
    return poles[order], shapes[:, order]


def _with_losses(
    poles: ComplexArray,
    m: ComplexArray,
    c: ComplexArray,
    k: ComplexArray,
    drives: ComplexArray,
    others: ComplexArray,
    *relaxing: ComplexArray,
    power: Array,
    rates_rad_s: Array,
) -> ComplexArray:
    """Poles where the stored part of losses is the mode's own: Newton on v' Z(s) v."""
    s = poles
    for _ in range(_NEWTON_STEPS):
        value = s**2 * m + s * c + k + lost_by_power(s, power) * drives + hysteresis(s) * others
        slope = 2.0 * s * m + c + lost_by_power_slope_of_line(s, power) * drives
        for part, rate in zip(relaxing, rates_rad_s, strict=True):
            value += relaxed(s, rate) * part
            slope += relaxed_slope_of_line(s, rate) * part
        s = s - value / (slope + (2.0 / np.pi) * others / s)
    return np.asarray(s)


def disagreement_map(stage: Stage, fit: Fit, points: Sequence[str]) -> tuple[Disagreement, ...]:
    """Residual over what scatter and allowance explain, by posture, point, axis and band.

    The point is that of what went round, sensor or hammer; the axis is always the sensor's.
    """
    found = []
    for p, lines in enumerate(stage.lines):
        y = stage.models[p].values(fit.hypothesis, lines, fit.values)
        left = np.abs(stage.weighings[p].cleaned(y)) ** 2 / 2.0
        f = lines.s_rad_s.imag / (2.0 * np.pi)
        edges = np.geomspace(f[0] * 0.999, f[-1] * 1.001, _BANDS + 1)
        for low, high in pairwise(edges):
            inside = (f >= low) & (f < high)
            if not inside.any():
                continue
            ratio = np.sqrt(np.mean(left[..., inside], axis=-1))
            for m, point in enumerate(lines.moved_point):
                found += [
                    Disagreement(
                        posture=lines.title,
                        point=points[point],
                        axis=axis,
                        band_hz=(float(low), float(high)),
                        ratio=float(ratio[m, a]),
                    )
                    for a, axis in enumerate("xyz")
                ]
    return tuple(found)
