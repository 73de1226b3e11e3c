"""FRFs of a known modal model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm

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


@dataclass(frozen=True, slots=True, kw_only=True)
class EightModes:
    """FRFs with the truth behind them."""

    frf: FrequencyResponse
    poles: np.ndarray  # (8,) rad/s
    residues: np.ndarray  # (8, n_resp, n_ref) receptance


def eight_modes(
    rng,
    *,
    form=FrfForm.RECEPTANCE,
    n_resp=30,
    n_ref=1,
    complex_shapes=False,
    level=0.01,
    top_hz=200.0,
):
    """Eight modes, one close pair, noise of `level` times each FRF's RMS."""
    damping = rng.uniform(0.02, 0.045, 8)
    poles = poles_of(EIGHT_HZ, damping)
    shapes = rng.standard_normal((8, n_resp, 1))
    if complex_shapes:
        shapes = shapes * np.exp(0.3j * rng.standard_normal((8, n_resp, 1)))
    part = rng.uniform(0.3, 1.0, (8, 1, n_ref)) * rng.choice([-1.0, 1.0], (8, 1, n_ref))
    residues = shapes * part / (2j * poles.imag[:, None, None])
    freq = np.arange(0.25, top_hz + 0.125, 0.25)
    clean = modal_frf(poles, residues, freq, form)
    frf = noisy_record(rng, clean, freq, form=form, level=level)
    return EightModes(frf=frf, poles=poles, residues=residues)


def cramer_rao_std(made):
    """Least standard deviations of (f, zeta), (n, 2), residues unknown, written out directly.

    Of complex noise with variance v the information on real parameters is 2 Re(J^H J) / v; each
    FRF's residues are eliminated by the Schur complement.
    """
    s = 2j * np.pi * made.frf.freq_hz
    p, n = made.poles, made.poles.size
    direct, mirrored = 1.0 / (s - p[:, None]), 1.0 / (s - p.conj()[:, None])
    power = POWER[made.frf.form]
    total = np.zeros((2 * n, 2 * n))
    for i, j in np.ndindex(made.frf.values.shape[:2]):
        R = made.residues[:, i, j][:, None]
        by_residue = np.concatenate([direct + mirrored, 1j * (direct - mirrored)])
        slope, turned = R * direct**2, R.conj() * mirrored**2
        by_pole = np.concatenate([slope + turned, 1j * (slope - turned)])
        J = np.concatenate([by_residue, by_pole]) * s**power
        J = J / np.sqrt(made.frf.variance[i, j])
        size = np.linalg.norm(J, axis=1)
        info = 2.0 * (J.conj() @ J.T).real / np.outer(size, size)
        R_R, R_P, P_P = info[: 2 * n, : 2 * n], info[: 2 * n, 2 * n :], info[2 * n :, 2 * n :]
        own = P_P - R_P.T @ np.linalg.solve(R_R, R_P)
        total += own * np.outer(size[2 * n :], size[2 * n :])
    C = np.linalg.inv(total)
    magnitude = np.abs(p)
    by_f = np.concatenate([np.diag(p.real / magnitude), np.diag(p.imag / magnitude)], axis=1)
    by_zeta = np.concatenate(
        [np.diag(-(p.imag**2) / magnitude**3), np.diag(p.real * p.imag / magnitude**3)], axis=1
    )
    f_std = np.sqrt(np.diag(by_f @ C @ by_f.T)) / (2.0 * np.pi)
    return np.stack([f_std, np.sqrt(np.diag(by_zeta @ C @ by_zeta.T))], axis=1)
