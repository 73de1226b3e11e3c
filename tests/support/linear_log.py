"""A log of small motion, from the linear equations of an arm that shakes about a posture."""

import numpy as np
import scipy.signal

from armodal.analyzer.arm.reduced import selection
from armodal.analyzer.arm.structure import believed_structure
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.corrected.held import held_arm
from armodal.protocols.foreign.motion_log import MotionLog

STILL_S = 2.0
SMALL_RAD = 2e-5  # products of two such motions are next to nothing


def linear_log(corrected, joints_rad, *, point, seconds=5.0, rate_hz=1000.0):
    """What a corrected arm's accelerometer reads while drives 1 to 3 shake about a posture."""
    ready = held_arm(corrected)
    superset = Superset(ready.arm)
    believed = believed_structure(ready.arm)
    structure = type(believed)(
        joints=believed.joints,
        stiffness_n_m_per_rad=believed.stiffness_n_m_per_rad,
        damping_n_m_s_per_rad=believed.damping_n_m_s_per_rad,
        axes=ready.axes,
        held=ready.held,
    )
    posture = superset.posture(np.asarray(joints_rad))
    T = selection(superset, structure)
    D = np.eye(superset.n)[:, [superset.joint_column(i) for i in range(3)]]
    M, K, C = T.T @ posture.mass @ T, structure.springs(), structure.dampers()
    t = np.arange(int(seconds * rate_hz)) / rate_hz
    rng = np.random.default_rng(4)
    sos = scipy.signal.butter(3, (6.0, 60.0), "bandpass", fs=rate_hz, output="sos")
    # Still at the end until what rings has died away, or it would be there at the beginning.
    window = np.clip(np.minimum(t, t[-1] - STILL_S - t) / 0.5, 0.0, 1.0)[:, None]
    angles = SMALL_RAD * window * scipy.signal.sosfilt(sos, rng.normal(size=(len(t), 3)), axis=0)
    # In the frequency domain, the log repeated: M (x'' + d'') + C x' + K x = 0.
    s = 2j * np.pi * np.fft.rfftfreq(len(t), 1.0 / rate_hz)
    d = np.fft.rfft(angles, axis=0)
    J = posture.point_jacobian[superset.point_index[point], :3]
    acc = np.zeros((len(s), 3), dtype=complex)
    for i, (own, drive) in enumerate(zip(s, d, strict=True)):
        load = -(T.T @ posture.mass @ D) @ (own**2 * drive)
        x = np.linalg.solve(own**2 * M + own * C + K, load)
        acc[i] = own**2 * (J @ (T @ x + D @ drive))
    R = posture.point_rotation[superset.point_index[point]]
    whole = np.tile(joints_rad, (len(t), 1))
    whole[:, :3] += angles
    return MotionLog(
        rate_hz=rate_hz,
        slowest_hz=rate_hz,
        encoder_rad=whole,
        command_rad=None,
        acceleration_m_s2={point: np.fft.irfft(acc, len(t), axis=0) @ R},
        unused=(),
    )
