"""Modes made from the arm model, as if measured: every frequency and shape known exactly."""

import numpy as np

from armodal.analyzer.arm import reduce_model
from armodal.analyzer.arm.reduced import model_modes
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.analyzer.modal import Mode
from armodal.protocols.frf_records import Dof

ALL_POINTS = tuple(str(i) for i in range(1, 19))


def mode_of(pole_rad_s, shape):
    """Return a mode with a given pole and shape, turned as the modal fit turns them."""
    shape = np.asarray(shape, dtype=np.complex128)
    shape = shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))
    return Mode(
        pole_rad_s=complex(pole_rad_s),
        f_hz=float(np.abs(pole_rad_s) / (2 * np.pi)),
        f_std_hz=0.01,
        damping_ratio=float(-np.real(pole_rad_s) / np.abs(pole_rad_s)),
        damping_std=0.001,
        shape=shape / np.abs(shape).max(),
        shape_std=np.zeros(shape.shape, dtype=np.complex128),
        participation=np.ones(1, dtype=np.complex128),
        participation_std=np.zeros(1, dtype=np.complex128),
        residue_std=0.0,
        mpc=1.0,
        mpd_deg=0.0,
        mcf=0.0,
        dof=10.0,
        shape_dof=10.0,
        stability=1.0,
        significance=1e6,
    )


def dofs_of(superset, dynamics, points=ALL_POINTS):
    """Return the sensor axes of some points as measured directions."""
    return tuple(
        Dof(point=point, label=label, direction=dynamics.point_rotation[number][:, axis])
        for point in points
        for number in [superset.point_index[point]]
        for axis, label in enumerate("xyz")
    )


def made_modes(superset, posture_rad, structure, points=ALL_POINTS):
    """Return the modes of a structure in a posture as measured modes, lowest first."""
    dynamics = superset.posture(posture_rad)
    model = reduce_model(superset, dynamics, structure)
    modes = model_modes(model)
    dofs = dofs_of(superset, dynamics, points)
    bare = MeasuredModes(superset, dynamics, (), dofs)
    shapes = bare.rows(model.point_jacobian) @ modes.shape
    made = tuple(mode_of(p, s) for p, s in zip(modes.pole_rad_s, shapes.T, strict=True))
    return MeasuredModes(superset, dynamics, made, dofs)
