"""FRFs of the arm model on Laplace lines, and their derivatives by the model's parameters.

With Z(s) = s² M + s C + K, b the generalised force of a unit hit and o the output rows of an
accelerometer, the accelerance is y = o Z⁻¹ b, and for any parameter

    dy = do Z⁻¹ b - (o Z⁻¹) dZ (Z⁻¹ b) + (o Z⁻¹) db .

The mass of the roving accelerometer rides at its own point, so M differs from mounting to
mounting; o holds the accelerometer's sense of gravity (a - g in turning axes) beside s² J.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.reduced import selection
from armodal.analyzer.arm.superset import PostureDynamics, Superset
from armodal.analyzer.given_frfs import complete_points
from armodal.analyzer.identification.parameters import FitState
from armodal.analyzer.screws.cross import across, skew
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse, FrfForm

__all__ = ["PostureData", "posture_data", "predict", "predict_with_derivatives"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureData:
    """One posture's FRFs brought into the form the model predicts.

    A mounting is one sensor point; its three rows are the sensor's axes.
    """

    name: str
    dynamics: PostureDynamics
    s_rad_s: ComplexArray  # (n_lines,)
    sensor_point: npt.NDArray[np.int64]  # (n_mountings,) index into the arm's points
    hit_point: npt.NDArray[np.int64]  # (n_refs,)
    hit_direction: Array  # (n_refs, 3) base frame
    values: ComplexArray  # (n_mountings, n_refs, 3, n_lines) accelerance
    variance: Array  # same shape: E|error|²
    sensor_mass_kg: float
    one_direction: bool  # all hits of the posture share one planned direction


def posture_data(
    superset: Superset, frf: FrequencyResponse, *, sensor_mass_kg: float, stride: int = 1
) -> PostureData:
    """Arrange a posture's FRFs by mounting and reference for the model fit.

    Raises
    ------
    EstimateError
        If the posture's joint angles are unknown, or a response is not one of three
        perpendicular axes x, y, z.
    """
    frf = complete_points(frf)
    if frf.joints_rad is None:
        raise EstimateError(
            f"posture '{frf.posture}' has no measured joint angles, so no model can be set "
            "beside it; measure it with the controller's angles on the bus"
        )
    points = list(dict.fromkeys(dof.point for dof in frf.responses))
    rows = {(dof.point, dof.label): i for i, dof in enumerate(frf.responses)}
    try:
        order = np.array([[rows[point, label] for label in "xyz"] for point in points])
    except KeyError as missing:
        raise EstimateError(
            f"posture '{frf.posture}' lacks the response {missing.args[0]}; "
            "a triaxial sensor gives x, y and z at each point"
        ) from missing
    lines = slice(None, None, stride)
    dynamics = superset.posture(frf.joints_rad)
    sensor_point = np.array([superset.point_index[point] for point in points])
    s = frf.decay_rad_s + 2j * np.pi * frf.freq_hz[lines]
    # Accelerance is s² times receptance, s times mobility, exactly on any line s.
    factor = s ** {FrfForm.RECEPTANCE: 2, FrfForm.MOBILITY: 1, FrfForm.ACCELERANCE: 0}[frf.form]
    values = np.moveaxis(frf.values[order][..., lines] * factor, 1, 2)
    variance = np.moveaxis(frf.variance[order][..., lines] * np.abs(factor) ** 2, 1, 2)
    turn = _to_sensor_axes(frf, order, dynamics.point_rotation[sensor_point])
    if turn is not None:
        values = np.einsum("mij,mrjl->mril", turn, values)
        variance = np.einsum("mij,mrjl->mril", turn**2, variance)
    return PostureData(
        name=frf.posture,
        dynamics=dynamics,
        s_rad_s=s,
        sensor_point=sensor_point,
        hit_point=np.array([superset.point_index[dof.point] for dof in frf.references]),
        hit_direction=np.array([dof.direction for dof in frf.references]),
        values=values,
        variance=variance,
        sensor_mass_kg=sensor_mass_kg,
        one_direction=len(frf.references) == 1,
    )


def _to_sensor_axes(
    frf: FrequencyResponse, order: npt.NDArray[np.int64], rotation: Array
) -> Array | None:
    """Rotations (n_mountings, 3, 3) from the measured axes to the sensors'; None if the same.

    Imported FRFs may lie along the axes of base or link instead of the sensor's.
    """
    directions = np.array([[frf.responses[i].direction for i in row] for row in order])
    turn: Array = np.einsum("mji,mkj->mik", rotation, directions)
    unit = np.eye(3)
    if np.allclose(turn, unit, atol=1e-9):
        return None
    if not np.allclose(turn @ turn.transpose(0, 2, 1), unit, atol=1e-6):
        raise EstimateError(
            f"posture '{frf.posture}': wanted three perpendicular responses at each point, got "
            "others; measure x, y and z"
        )
    return turn


def predict(superset: Superset, data: PostureData, state: FitState, posture: int) -> ComplexArray:
    """Model FRFs of a posture.

    Returns
    -------
    (n_mountings, n_refs, 3, n_lines) complex128
        Accelerance in m/(N s²), gains included.
    """
    parts = _assemble(superset, data, state, posture)
    X: ComplexArray = np.linalg.solve(parts.Z, _hits(parts))
    return _response(parts, X, np.exp(state.log_gain))


def predict_with_derivatives(
    superset: Superset, data: PostureData, state: FitState, posture: int
) -> tuple[ComplexArray, ComplexArray]:
    """Model FRFs of a posture, and their derivatives by every parameter.

    Returns
    -------
    y : (n_mountings, n_refs, 3, n_lines) complex128
        Accelerance in m/(N s²), gains included.
    dy : (n_parameters, n_mountings, n_refs, 3, n_lines) complex128
    """
    parts = _assemble(superset, data, state, posture)
    gain = np.exp(state.log_gain)
    # X: motion under the hit; Y: motion under unit loads at the sensor's axes (Z is symmetric).
    solved = np.linalg.solve(parts.Z, np.concatenate([_hits(parts), parts.o], axis=-1))
    n_refs = parts.b.shape[1]
    X: ComplexArray = solved[..., :n_refs]
    Y: ComplexArray = solved[..., n_refs:] * gain
    y = _response(parts, X, gain)
    by_structure = _derivatives(data, state, parts, X, Y)
    n_free = len(by_structure)
    dy = np.zeros((n_free + 3 + state.hit_tilt_rad.size, *y.shape), dtype=np.complex128)
    for row, value in enumerate(by_structure):
        dy[row] = value
    for axis in range(3):
        dy[n_free + axis, :, :, axis] = y[:, :, axis]
    if data.one_direction:
        at = n_free + 3 + 2 * posture
        for side in range(2):
            tilted = parts.hit_linear[0].T @ across(data.hit_direction[0])[:, side]
            dy[at + side, :, 0] = np.einsum("mlni,n->mil", Y, tilted)
    return y, dy


def _hits(parts: _Parts) -> ComplexArray:
    return np.broadcast_to(parts.b, (*parts.Z.shape[:2], *parts.b.shape))


def _response(parts: _Parts, X: ComplexArray, gain: Array) -> ComplexArray:
    return np.asarray(np.einsum("mlni,mlnr->mril", parts.o, X) * gain[:, None])


@dataclass(frozen=True, slots=True, kw_only=True)
class _Parts:
    T: Array  # (n_super, n)
    Z: ComplexArray  # (mountings, lines, n, n)
    b: Array  # (n, refs)
    o: ComplexArray  # (mountings, lines, n, 3): output rows, transposed
    hit_linear: Array  # (refs, 3, n)
    force: Array  # (refs, 3)
    M_super: Array  # (mountings, n_super, n_super)


def _assemble(superset: Superset, data: PostureData, state: FitState, posture: int) -> _Parts:
    structure, dynamics, s = state.structure, data.dynamics, data.s_rad_s
    T = selection(superset, structure)
    J_sensor = dynamics.point_jacobian[data.sensor_point]  # (mountings, 6, n_super)
    linear = J_sensor[:, :3]
    M_super = dynamics.mass + data.sensor_mass_kg * np.einsum("mia,mib->mab", linear, linear)
    M = T.T @ M_super @ T + structure.held_mass()
    K = T.T @ dynamics.gravity_stiffness @ T + structure.springs()
    C = structure.dampers()
    Z = (s**2)[:, None, None] * M[:, None] + s[:, None, None] * C + K
    hit_linear = dynamics.point_jacobian[data.hit_point][:, :3] @ T
    force = data.hit_direction
    if data.one_direction:
        force = force + across(force[0]) @ state.hit_tilt_rad[posture]
    b = np.einsum("rin,ri->nr", hit_linear, force)
    return _Parts(
        T=T,
        Z=Z,
        b=b,
        o=_output(data, J_sensor @ T),
        hit_linear=hit_linear,
        force=force,
        M_super=M_super,
    )


def _output(data: PostureData, J: Array) -> ComplexArray:
    """Output rows (mountings, lines, n, 3): Rᵀ (s² J_v + θ x g), see the module's head."""
    R = data.dynamics.point_rotation[data.sensor_point]
    moved = np.einsum("mji,mjn->mni", R, J[:, :3])
    # a - g seen in axes turned by θ changes by θ x g.
    tilt = skew(-data.dynamics.gravity_m_s2) @ J[:, 3:]
    weighed = np.einsum("mji,mjn->mni", R, tilt)
    s2 = (data.s_rad_s**2)[None, :, None, None]
    return np.asarray(s2 * moved[:, None] + weighed[:, None])


def _derivatives(
    data: PostureData,
    state: FitState,
    parts: _Parts,
    X: ComplexArray,
    Y: ComplexArray,
) -> list[ComplexArray]:
    structure, s = state.structure, data.s_rad_s
    n_joints = len(structure.joints)
    n = n_joints + len(structure.axes)
    by_unit = -np.einsum("mlni,mlnr->nmril", Y[:, :, :n], X[:, :, :n])
    springs = structure.all_stiffness()[:n, None, None, None, None] * by_unit
    dampers = structure.all_damping()[:n, None, None, None, None] * s * by_unit
    dy = [*springs[:n_joints], *dampers[:n_joints]]
    gain = np.exp(state.log_gain)
    for i, axis in enumerate(structure.axes, start=n_joints):
        frame = across(axis.direction)
        # A tilted axis keeps its nearest point: dp = -u_axis (p . du) keeps p ⟂ u.
        dp = -np.outer(axis.direction, axis.point_m @ frame)
        tilts = np.vstack([skew(axis.point_m) @ frame - skew(axis.direction) @ dp, frame])
        shifts = np.vstack([-skew(axis.direction) @ frame, np.zeros((3, 2))])
        dy += [
            *_moved_axis(data, parts, X, Y, gain, i, axis.link, np.hstack([tilts, shifts])),
            springs[i],
            dampers[i],
        ]
    return dy


def _moved_axis(
    data: PostureData,
    parts: _Parts,
    X: ComplexArray,
    Y: ComplexArray,
    gain: Array,
    column: int,
    link: int,
    twists: Array,
) -> ComplexArray:
    """Derivatives of y when the superset motion of one column changes at a link.

    `twists` are (6, n_twists); the derivatives are (n_twists, *y.shape).
    """
    T, dynamics, s = parts.T, data.dynamics, data.s_rad_s
    dt = np.zeros((T.shape[0], twists.shape[1]))
    dt[Superset.interface_columns(link)] = twists
    # dZ is symmetric with only one row and column changed: dZ = e zᵀ + z eᵀ.
    inertial = (T.T @ (parts.M_super @ dt)).transpose(2, 0, 1)  # (n_twists, mountings, n)
    stiff = (T.T @ (dynamics.gravity_stiffness @ dt)).T
    z = (s**2)[:, None] * inertial[:, :, None] + stiff[:, None, None]
    zX = np.einsum("qmln,mlnr->qmrl", z, X)
    zY = np.einsum("qmln,mlni->qmil", z, Y)
    at_x, at_y = X[:, :, column].transpose(0, 2, 1), Y[:, :, column].transpose(0, 2, 1)
    J = dynamics.point_jacobian
    db = np.einsum("rnq,rn->qr", J[data.hit_point][:, :3] @ dt, parts.force)
    do = (_output(data, J[data.sensor_point] @ dt) * gain).transpose(2, 0, 3, 1)
    from_hit = (db[:, None, :, None] - zX)[:, :, :, None] * at_y[:, None]
    return np.asarray(from_hit + (do - zY)[:, :, None] * at_x[:, :, None])
