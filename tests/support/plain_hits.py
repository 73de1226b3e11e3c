"""Six hits on a plain structure, as files of another program with their import manifest."""

from __future__ import annotations

import numpy as np
from support import hammer
from support.simulated_frfs import poles_of

RATE, SAMPLES = 1024, 2048
POLES = poles_of([20.0, 45.0], [0.02, 0.015])
SHAPES = np.array([[0.8, 0.6, -0.5], [0.7, -0.6, 0.4]])
ASKEW = 5  # of six hits, with a fifth more of everything: it was struck elsewhere


def write_hits(folder):
    """Write hits at the driving point, as tables of time, force, response; return their names."""
    rng = np.random.default_rng(5)
    residues = (SHAPES[:, 0] * SHAPES[:, 0])[:, None] / (2j * POLES.imag[:, None])
    names = []
    for hit in range(6):
        record = 80.0 * hammer.band_limited(SAMPLES, RATE, 0.05, 4e-3, POLES, residues)
        record[1] *= 1.2 if hit == ASKEW else 1.0 + 0.005 * rng.standard_normal()
        record += 0.002 * rng.standard_normal(record.shape)
        names.append(f"m{hit + 1}.npy")
        np.save(folder / names[-1], np.vstack([np.arange(SAMPLES) / RATE, record]))
    return names


def write_manifest(folder):
    """Write the hits and the manifest that imports them; return the manifest's path."""
    manifest = folder / "manifest.toml"
    manifest.write_text(
        'arm = "none"\nmode = "roving-response"\nunits = "SI"\n[windows]\nexponential_end = 0.1\n'
        f'[[postures]]\nname = "structure"\nhit_point = "1"\nfiles = {write_hits(folder)}\n'
    )
    return manifest
