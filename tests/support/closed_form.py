"""FRFs in closed form: three real modes seen at two triaxial points, both hit obliquely."""

import numpy as np

from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm

FREQ_HZ = np.arange(8.0, 120.0, 0.5)
DECAY = 1.5
S = DECAY + 2j * np.pi * FREQ_HZ
F_HZ = np.array([17.0, 34.0, 70.0])
ZETA = np.array([0.02, 0.03, 0.025])
POLES = 2 * np.pi * F_HZ * (-ZETA + 1j * np.sqrt(1 - ZETA**2))
SHAPES = {  # (3, n_modes) motion of a point, base axes
    "a": np.array([[1.0, 0.3, -0.5], [0.2, 0.9, 0.4], [-0.3, 0.2, 0.8]]),
    "b": np.array([[0.4, -0.8, 0.6], [0.5, 0.3, -0.2], [0.1, 0.5, 0.7]]),
}
HITS = {
    "a": np.array([0.6, 0.64, 0.48]),
    "b": np.array([0.48, -0.6, 0.64]),
}


def receptance(i, j, stiffness=1.0):
    """(3, n_freq) displacement of point i per newton of the hit at point j."""
    w2 = (2 * np.pi * F_HZ) ** 2 * stiffness
    dynamic = S[:, None] ** 2 + 4 * np.pi * ZETA * F_HZ * np.sqrt(stiffness) * S[:, None] + w2
    return SHAPES[i] @ ((SHAPES[j].T @ HITS[j]) / dynamic).T


def frequency_response(points, hits, *, form=FrfForm.ACCELERANCE, noise=0.0, rng=None):
    """FRFs at points (x, y, z each) per hits; complex noise relative to each FRF's rms."""
    power = {FrfForm.RECEPTANCE: 0, FrfForm.MOBILITY: 1, FrfForm.ACCELERANCE: 2}[form]
    values = np.stack(
        [np.concatenate([S**power * receptance(i, j) for i in points]) for j in hits], axis=1
    )
    level = np.mean(np.abs(values) ** 2, axis=-1, keepdims=True)
    if rng is not None:
        z = rng.standard_normal((2, *values.shape))
        values = values + noise * np.sqrt(level / 2) * (z[0] + 1j * z[1])
    return FrequencyResponse(
        posture="p",
        form=form,
        freq_hz=FREQ_HZ,
        decay_rad_s=DECAY,
        values=values,
        coherence=np.ones(values.shape),
        variance=np.broadcast_to(np.maximum(noise**2, 1e-8) * level, values.shape),
        n_hits=np.full(values.shape[:2], 3),
        responses=tuple(
            Dof(point=i, label=label, direction=axis)
            for i in points
            for label, axis in zip("xyz", np.eye(3), strict=True)
        ),
        references=tuple(Dof(point=j, label="hit", direction=HITS[j]) for j in hits),
        joints_rad=None,
    )
