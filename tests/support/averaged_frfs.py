"""FRFs of a known structure as an analyser averages them, with their coherence."""

from dataclasses import dataclass, replace

import numpy as np
from support.simulated_frfs import modal_frf, poles_of, record

from armodal.protocols.frf_records import FrfForm

FREQ = np.arange(20, 500) * 0.25
N_POINTS = 4


@dataclass(frozen=True)
class Averaged:
    frf: object
    f_hz: np.ndarray
    variance: np.ndarray  # (n_points, 1, n_freq), the true one


def averaged(rng, n_averages, noise=0.02):
    """Three modes at four points: H1 and coherence of hits with white noise on the responses."""
    f = np.array([24.0, 58.0, 91.0]) * (1.0 + 0.03 * rng.uniform(-1.0, 1.0, 3))
    poles = poles_of(f, rng.uniform(0.005, 0.02, 3))
    residues = rng.normal(size=(3, N_POINTS, 1)) * rng.uniform(0.5, 1.0, (3, 1, 1))
    residues = residues / (2j * poles.imag[:, None, None])
    H = modal_frf(poles, residues, FREQ, FrfForm.ACCELERANCE)[:, 0]
    force = rng.uniform(0.8, 1.2, (n_averages, N_POINTS, 1)) * np.exp(-((FREQ / 200.0) ** 2))
    sigma = noise * np.sqrt(np.mean(np.abs(H) ** 2, axis=-1, keepdims=True))
    parts = rng.normal(size=(2, n_averages, N_POINTS, FREQ.size)) / np.sqrt(2.0)
    response = H * force + sigma * (parts[0] + 1j * parts[1])
    cross, power = (response * force).sum(0), (force**2).sum(0)
    coherence = np.abs(cross) ** 2 / (power * (np.abs(response) ** 2).sum(0))
    frf = replace(
        record((cross / power)[:, None], FREQ, hits=n_averages), coherence=coherence[:, None]
    )
    variance = np.broadcast_to(sigma**2 / power, H.shape)[:, None]
    return Averaged(frf=frf, f_hz=f, variance=variance)
