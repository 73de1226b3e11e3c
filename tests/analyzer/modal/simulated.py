"""FRFs of a known modal model."""

from __future__ import annotations

import numpy as np

from protocols.frf_records import Dof, FrequencyResponse, FrfForm

POWER = {FrfForm.RECEPTANCE: 0, FrfForm.MOBILITY: 1, FrfForm.ACCELERANCE: 2}


def poles_of(f_hz, damping):
    w = 2.0 * np.pi * np.asarray(f_hz, float)
    zeta = np.asarray(damping, float)
    return w * (-zeta + 1j * np.sqrt(1.0 - zeta**2))


def modal_frf(poles, residues, freq_hz, form, decay=0.0):
    """(n_resp, n_ref, n_freq) of receptance residues (n_modes, n_resp, n_ref)."""
    s = decay + 2j * np.pi * freq_hz
    total = sum(
        R[..., None] / (s - p) + R.conj()[..., None] / (s - np.conj(p))
        for p, R in zip(poles, residues, strict=True)
    )
    return total * s ** POWER[form]


def record(values, freq_hz, *, variance=None, form=FrfForm.ACCELERANCE, decay=0.0, axes=1, hits=3):
    n_resp, n_ref, _ = values.shape
    unit = np.array([0.0, 0.0, 1.0])
    return FrequencyResponse(
        posture="p",
        form=form,
        freq_hz=freq_hz,
        decay_rad_s=decay,
        values=values,
        coherence=np.ones(values.shape),
        variance=np.zeros(values.shape) if variance is None else variance,
        n_hits=np.full((n_resp, n_ref), hits),
        responses=tuple(
            Dof(point=str(i // axes + 1), label="xyz"[i % axes], direction=unit)
            for i in range(n_resp)
        ),
        references=tuple(Dof(point=f"h{j}", label="hit", direction=unit) for j in range(n_ref)),
        joints_rad=None,
    )


def noisy_record(rng, clean, freq_hz, *, form, level, axes=1):
    """Complex white noise of `level` times each FRF's RMS, its variance stated."""
    sigma = level * np.sqrt(np.mean(np.abs(clean) ** 2, axis=-1, keepdims=True))
    noise = rng.standard_normal((2, *clean.shape)) / np.sqrt(2.0)
    variance = np.broadcast_to(sigma**2, clean.shape)
    values = clean + sigma * (noise[0] + 1j * noise[1])
    return record(values, freq_hz, variance=variance, form=form, axes=axes)


EIGHT_HZ = np.array([9.0, 13.0, 13.4, 34.0, 37.0, 55.0, 66.0, 107.0])


def eight_modes(rng, *, form=FrfForm.RECEPTANCE, n_resp=30, complex_shapes=False):
    """Eight modes, one close pair, one reference, 1 % noise of each FRF's RMS."""
    damping = rng.uniform(0.02, 0.045, 8)
    poles = poles_of(EIGHT_HZ, damping)
    shapes = rng.standard_normal((8, n_resp, 1))
    if complex_shapes:
        shapes = shapes * np.exp(0.3j * rng.standard_normal((8, n_resp, 1)))
    part = rng.uniform(0.3, 1.0, (8, 1, 1)) * rng.choice([-1.0, 1.0], (8, 1, 1))
    residues = shapes * part / (2j * poles.imag[:, None, None])
    freq = np.arange(1, 1601) * 0.25
    clean = modal_frf(poles, residues, freq, form)
    return noisy_record(rng, clean, freq, form=form, level=0.01), poles
