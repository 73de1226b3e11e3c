"""Coverage of nominal 95 % intervals of frequency, damping and shape, over simulated sessions.

Every session is simulated hit by hit in the time domain: three hits a point, three axes that
share each hit, counts, noise on every channel, an aim that changes with each hit.
"""

import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from scipy.stats import t as student

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "analyzer" / "modal"))

import hammer
from simulated import poles_of

from analyzer.modal import fit_modes, posture_frf

SEEDS = range(200)
POLES = poles_of([11.0, 12.5, 38.0, 79.0], [0.03, 0.035, 0.025, 0.02])
TRUTH = np.array([[11.0, 0.03], [12.5, 0.035], [38.0, 0.025], [79.0, 0.02]])


def run(name: str, *, noise: float, aim: float) -> None:
    inside, shapes, errors, missed = [], [], [], 0
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        R = 0.3 * rng.standard_normal((4, 8, 3)) / (2j * POLES.imag[:, None, None])
        session = hammer.session(POLES, R, rng=rng, noise=noise, aim=aim, anti_alias=True)
        model = fit_modes(posture_frf(session, "p", lambda _: np.eye(3), band_hz=(3.0, 150.0)))
        if len(model.modes) != len(POLES):
            missed += 1
            continue
        for mode, truth, residue in zip(model.modes, TRUTH, R.reshape(4, -1), strict=True):
            reach = student.ppf(0.975, mode.dof)
            error = np.array([mode.f_hz, mode.damping_ratio]) - truth
            std = np.array([mode.f_std_hz, mode.damping_std])
            inside.append(np.abs(error) < reach * std)
            errors.append(error / truth)
            largest = np.argmax(np.abs(mode.shape))
            off = mode.shape - (residue / residue[largest]).real
            reach = student.ppf(0.975, mode.shape_dof)
            rest = np.arange(off.size) != largest
            shapes.append(np.mean(np.abs(off.real)[rest] < reach * mode.shape_std.real[rest]))
    f, zeta = 100.0 * np.mean(inside, axis=0)
    rms = 100.0 * np.sqrt(np.mean(np.square(errors), axis=0))
    print(
        f"{name}: f {f:.1f} %, damping {zeta:.1f} %, shape {100 * np.mean(shapes):.1f} % inside of "
        f"nominal 95 %, 90 to 98 wanted; RMS error f {rms[0]:.4f} %, damping {rms[1]:.3f} %; "
        f"{missed} of {len(SEEDS)} sessions without all modes",
        flush=True,
    )


def main() -> None:
    run("noise alone", noise=0.3, aim=0.0)
    run("noise and aim", noise=0.1, aim=0.02)
    run("aim alone", noise=0.001, aim=0.02)


if __name__ == "__main__":
    main()
