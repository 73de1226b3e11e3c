"""FRFs of a structure whose resonances move from mounting to mounting, in closed form."""

from dataclasses import dataclass

import numpy as np
from support.simulated_frfs import record

N_POINTS, N_AXES = 8, 3
FOUR_HZ = (11.0, 24.0, 58.0, 81.0)
TWO_HZ = (11.0, 24.0)


@dataclass(frozen=True)
class Drifting:
    frf: object
    f_hz: np.ndarray  # (n_points, n_modes) at each mounting
    still_hz: np.ndarray  # (n_modes,) without what moves it
    damping: np.ndarray  # (n_modes,)


def drifting(rng, bandwidths, *, by="sensor", noise=0.01, nominal_hz=FOUR_HZ):
    """Modes that move over a range of so many half-power bandwidths.

    By the sensor's mass the shift grows with the squared shape at the sensor, by batches of four
    points each with its own temperature.
    """
    freq = np.arange(1, round(5.2 * max(nominal_hz))) * 0.25
    still = np.array(nominal_hz) * (1.0 + 0.05 * rng.uniform(-1.0, 1.0, len(nominal_hz)))
    damping = rng.uniform(0.005, 0.02, still.size)
    shape = rng.normal(size=(N_POINTS, N_AXES, still.size))
    shape /= np.abs(shape).max(axis=(0, 1))
    load = np.sum(shape**2, axis=1)
    if by == "batch":
        load = np.repeat(np.arange(N_POINTS)[:, None] // 4, still.size, axis=1).astype(float)
    f_hz = still * (1.0 - bandwidths * 2.0 * damping * load / load.max(axis=0))
    part = rng.uniform(0.3, 1.0, still.size) * rng.choice([-1.0, 1.0], still.size)
    s = 2j * np.pi * freq
    poles = 2.0 * np.pi * f_hz * (-damping + 1j * np.sqrt(1.0 - damping**2))
    residues = shape * part / (2j * poles.imag[:, None, :])
    clean = np.sum(
        residues[..., None] / (s - poles[:, None, :, None])
        + residues.conj()[..., None] / (s - poles.conj()[:, None, :, None]),
        axis=2,
    )
    clean = (clean * s**2).reshape(N_POINTS * N_AXES, 1, freq.size)
    sigma = noise * np.sqrt(np.mean(np.abs(clean) ** 2, axis=-1, keepdims=True))
    scatter = rng.normal(size=clean.shape) + 1j * rng.normal(size=clean.shape)
    frf = record(
        clean + sigma * scatter / np.sqrt(2.0),
        freq,
        variance=np.broadcast_to(sigma**2, clean.shape),
        axes=N_AXES,
    )
    return Drifting(frf=frf, f_hz=f_hz, still_hz=still, damping=damping)
