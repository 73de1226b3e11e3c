"""FRFs over several references on measured scales, some of them not measured, and their truth."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from support.simulated_frfs import modal_frf, poles_of

from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm

F_HZ = (11.0, 17.0, 38.0, 41.0)
DAMPING = (0.03, 0.02, 0.015, 0.02)
FREQ = np.arange(4.0, 70.0, 0.25)
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, kw_only=True)
class SeveralReferences:
    """FRFs with the truth behind them."""

    frf: FrequencyResponse
    poles: np.ndarray  # (n_modes,) rad/s
    shapes: np.ndarray  # (n_points, n_modes) of unit modal mass, 1/sqrt(kg)
    at: tuple[int, ...]  # points that are hit

    @property
    def modal_mass_kg(self) -> np.ndarray:
        """Of shapes scaled to a largest magnitude of 1."""
        return 1.0 / np.max(np.abs(self.shapes), axis=0) ** 2


def without(frf: FrequencyResponse, measured: np.ndarray) -> FrequencyResponse:
    """The FRFs with all but some (n_resp, n_ref) not measured."""
    hole = ~measured
    values, variance = frf.values.copy(), frf.variance.copy()
    coherence, n_hits = frf.coherence.copy(), frf.n_hits.copy()
    values[hole], variance[hole], coherence[hole], n_hits[hole] = 0.0, np.inf, np.nan, 0
    return replace(frf, values=values, variance=variance, coherence=coherence, n_hits=n_hits)


def several_references(rng, *, n_points=12, at=(0, 4, 8), told=True) -> SeveralReferences:
    """Accelerances in m/(N s^2), one axis a point; the points that are hit move by 1 to 1e-3.

    A sensor's noise is 0.003 to 0.03 of the FRFs that its reference gives. Driving points are not
    measured.
    """
    poles = poles_of(F_HZ, DAMPING)
    shapes = rng.standard_normal((n_points, poles.size)) / np.sqrt(rng.uniform(1.0, 30.0, 4))
    shapes[list(at)] = np.sign(shapes[list(at)]) * np.maximum(np.abs(shapes[list(at)]), 0.1)
    shapes[list(at)] *= np.logspace(0.0, -3.0, len(at))[:, None]
    residues = np.einsum("im,jm->mij", shapes, shapes[list(at)]) / (2j * poles.imag[:, None, None])
    clean = modal_frf(poles, residues, FREQ, FrfForm.ACCELERANCE)
    size = np.sqrt(np.mean(np.abs(clean) ** 2, axis=(0, 2)))  # of each reference
    sigma = 10.0 ** rng.uniform(-2.5, -1.5, n_points)[:, None] * size
    noise = rng.standard_normal((2, *clean.shape)) / np.sqrt(2.0)
    values = clean + sigma[..., None] * (noise[0] + 1j * noise[1])
    variance = np.broadcast_to(sigma[..., None] ** 2 if told else 0.0, clean.shape)
    frf = FrequencyResponse(
        posture="p",
        form=FrfForm.ACCELERANCE,
        freq_hz=FREQ,
        decay_rad_s=0.0,
        values=values,
        coherence=np.full(values.shape, np.nan),
        variance=variance,
        n_hits=np.full(values.shape[:2], 3),
        responses=tuple(Dof(point=str(i), label="z", direction=UP) for i in range(n_points)),
        references=tuple(Dof(point=str(i), label="hit", direction=UP) for i in at),
        joints_rad=None,
    )
    measured = np.ones(values.shape[:2], dtype=bool)
    measured[list(at), range(len(at))] = False
    return SeveralReferences(frf=without(frf, measured), poles=poles, shapes=shapes, at=tuple(at))
