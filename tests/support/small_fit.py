"""Small problems for the model fit: few mountings, few lines, a structure known exactly."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation
from support.plain_arm import TESTS_DEG

from armodal.analyzer.arm import Axis, Structure
from armodal.analyzer.identification.frf_model import PostureData, predict
from armodal.analyzer.identification.parameters import FitState

# The direction of the force that each test posture of file 000 is hit in, base frame.
HITS = ((0.42, 0.91, 0.0), (0.9, -0.42, 0.1), (0.1, 0.2, -0.97))


def true_axis():
    """Return an axis like that of file 000 in the simulated arm's first link."""
    direction = np.array([1.0, 0.0, 0.29]) / np.hypot(1.0, 0.29)
    point = np.array([0.0, 0.0182, 0.1955])
    return Axis(
        link=0,
        direction=direction,
        point_m=point - direction * (direction @ point),
        stiffness_n_m_per_rad=89000.0,
        damping_n_m_s_per_rad=8.4,
    )


def true_structure(axes=(), joints=(0, 1, 2)):
    """Return joints with the stiffness and damping of file 000, Table 4, and some axes."""
    joints = list(joints)
    return Structure(
        joints=tuple(joints),
        stiffness_n_m_per_rad=np.array([20789.0, 24307.0, 21243.0])[joints],
        damping_n_m_s_per_rad=np.array([15.2, 8.46, 5.9])[joints],
        axes=tuple(axes),
    )


def state_of(structure, n_postures):
    """Return a fit's state with perfect sensors and hits as planned."""
    return FitState(
        structure=structure, log_gain=np.zeros(3), hit_tilt_rad=np.zeros((n_postures, 2))
    )


def unmeasured(superset, test, points, freq_hz, *, decay_rad_s=2.0, mass_kg=0.0093, n_refs=1):
    """Return a test posture's data with every value still zero."""
    shape = (len(points), n_refs, 3, len(freq_hz))
    force = np.array(HITS[test]) / np.linalg.norm(HITS[test])
    return PostureData(
        name=f"test {test + 1}",
        dynamics=superset.posture(np.deg2rad(TESTS_DEG[test])),
        s_rad_s=decay_rad_s + 2j * np.pi * np.asarray(freq_hz),
        sensor_point=np.array([superset.point_index[point] for point in points]),
        hit_point=np.array([superset.point_index["1"]] * n_refs),
        hit_direction=np.stack([np.roll(force, i) for i in range(n_refs)]),
        values=np.zeros(shape, dtype=np.complex128),
        variance=np.zeros(shape),
        sensor_mass_kg=mass_kg,
        one_direction=n_refs == 1,
    )


def measured(superset, data, state, posture, rng=None, *, noise=0.0, tilt_rad=0.0):
    """Return data as measured: each mounting tilts its sensor, each value has its own noise.

    `noise` is relative to the root mean square of the FRFs.
    """
    y = predict(superset, data, state, posture)
    floor = noise * np.sqrt(np.mean(np.abs(y) ** 2))
    if rng is not None:
        turns = Rotation.from_rotvec(tilt_rad * rng.normal(size=(len(y), 3))).as_matrix()
        y = np.einsum("mij,mrjl->mril", turns, y)
        y = y + floor * (rng.normal(size=y.shape) + 1j * rng.normal(size=y.shape)) / np.sqrt(2)
    return replace(data, values=y, variance=np.full(y.shape, max(floor, 1e-9) ** 2))
