"""Amplitude at every resonance, from hits through the modal model and back.

Hits with known modes are averaged, fitted and synthesised;
at each resonance the synthesised accelerance of all FRFs is set beside the true one.
"""

import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support import hammer
from support.simulated_frfs import modal_frf, poles_of

from armodal.analyzer.modal import fit_modes, mass_scaling, posture_frf, synthesise
from armodal.protocols.frf_records import FrfForm

SEEDS = range(50)
F_HZ = np.array([11.0, 17.0, 38.0, 79.0])
POLES = poles_of(F_HZ, [0.03, 0.035, 0.025, 0.02])
DRIVING = 20  # z of point 7, hit along -z


def errors(seed: int, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """Relative errors of the amplitude at every resonance and of every modal mass."""
    rng = np.random.default_rng(seed)
    shapes = rng.uniform(0.3, 1.0, (4, 21)) * rng.choice([-1.0, 1.0], (4, 21))
    residues = -(shapes * shapes[:, DRIVING, None]) / (2j * POLES.imag[:, None])
    session = hammer.session(
        POLES, residues.reshape(4, 7, 3), rng=rng, noise=noise, anti_alias=True
    )
    frf = posture_frf(session, "p", lambda _: np.eye(3), band_hz=(3.0, 150.0))
    model = fit_modes(frf)
    truth = modal_frf(POLES, residues[:, :, None], F_HZ, FrfForm.ACCELERANCE)
    amplitude = np.linalg.norm(synthesise(model, F_HZ) - truth, axis=(0, 1))
    amplitude /= np.linalg.norm(truth, axis=(0, 1))
    true_mass = 1.0 / np.max(np.abs(shapes), axis=1) ** 2
    found = np.array([scaled.modal_mass_kg for scaled in mass_scaling(model)])
    return amplitude, found / true_mass - 1.0


def main() -> None:
    for noise in (1e-3, 0.1):
        amplitude, mass = zip(*(errors(seed, noise) for seed in SEEDS), strict=True)
        worst = 100.0 * np.max(amplitude, axis=0)
        print(
            f"noise {noise} N and m/s^2: largest amplitude error at each resonance of "
            f"{len(SEEDS)} sessions {np.round(worst, 2).tolist()} %, below 1 wanted; modal mass "
            f"{100.0 * np.max(np.abs(mass)):.2f} %"
        )


if __name__ == "__main__":
    main()
