"""Eight known modes, one pair 0.4 Hz apart, over seeds: what is found, and how close to the bound.

Truth 9, 13, 13.4, 34, 37, 55, 66, 107 Hz, damping 2 to 4.5 %, one reference, 30 responses, lines
0.25 to 400 Hz by 0.25, complex noise 1 % of each FRF's RMS, participation 0.3 to 1. The
Cramer-Rao bound is that of the poles with all residues unknown and nothing else. sdypy-EMA's
choice wants approximate frequencies: it is given the true ones.
"""

import os
import sys
import warnings
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.simulated_frfs import EIGHT_HZ, EightModes, cramer_rao_std, eight_modes

from armodal.analyzer.modal import fit_modes
from armodal.protocols.frf_records import FrequencyResponse, FrfForm

SEEDS = range(100)
F_TOLERANCE, DAMPING_TOLERANCE = 2e-3, 0.05
BOUND_SHARE = 0.2  # of the tolerance: beyond it a mode does not count


def sdypy_choice(frf: FrequencyResponse) -> np.ndarray:
    from sdypy import EMA  # noqa: PLC0415 - slow to import, and not timed

    step = frf.freq_hz[1] - frf.freq_hz[0]
    freq = np.concatenate([[0.0], frf.freq_hz, [frf.freq_hz[-1] + step]])
    model = EMA.Model(
        np.pad(frf.values[:, 0], ((0, 0), (1, 1))),  # it drops the last line
        freq,
        lower=frf.freq_hz[0],
        upper=freq[-1],
        pol_order_high=60,
        frf_form="receptance",
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model.get_poles(show_progress=False)
        model.select_closest_poles(list(EIGHT_HZ))
    return np.asarray(model.nat_freq)


def run(form: FrfForm, *, complex_shapes: bool) -> None:
    good, left_out, scaled = 0, 0, []
    worst_f, worst_zeta = 0.0, 0.0
    for seed in SEEDS:
        made: EightModes = eight_modes(
            np.random.default_rng(seed), form=form, complex_shapes=complex_shapes
        )
        model = fit_modes(made.frf)
        bound = cramer_rao_std(made)  # (8, 2) Hz and damping ratio
        damping = -made.poles.real / np.abs(made.poles)
        truth = np.stack([EIGHT_HZ, damping], axis=1)
        tolerance = truth * [F_TOLERANCE, DAMPING_TOLERANCE]
        counts = np.all(bound < BOUND_SHARE * tolerance, axis=1)
        left_out += int(np.sum(~counts))
        if len(model.modes) != EIGHT_HZ.size:
            print(f"  seed {seed}: {np.round(model.f_hz, 2)}")
            continue
        error = np.stack([model.f_hz, model.damping_ratio], axis=1) - truth
        good += bool(np.all(np.abs(error[counts]) < tolerance[counts]))
        worst_f = max(worst_f, float(np.max(np.abs(error[counts, 0]) / truth[counts, 0])))
        worst_zeta = max(worst_zeta, float(np.max(np.abs(error[counts, 1]) / truth[counts, 1])))
        scaled.append(error / bound)
    efficiency = np.sqrt(np.mean(np.square(scaled), axis=0))
    shapes = "complex" if complex_shapes else "real"
    print(
        f"{form}, {shapes} shapes: {good} of {len(SEEDS)} seeds right; worst f "
        f"{100 * worst_f:.3f} %, damping {100 * worst_zeta:.2f} %; {left_out} of "
        f"{8 * len(SEEDS)} modes beyond the bound"
    )
    print(
        f"  scatter over Cramer-Rao bound: f {efficiency[:, 0].min():.2f} to "
        f"{efficiency[:, 0].max():.2f}, damping {efficiency[:, 1].min():.2f} to "
        f"{efficiency[:, 1].max():.2f}; at most 1.3 wanted"
    )


def main() -> None:
    for form in FrfForm:
        run(form, complex_shapes=False)
    run(FrfForm.RECEPTANCE, complex_shapes=True)
    right, shown = 0, []
    try:
        for seed in SEEDS:
            frf = eight_modes(np.random.default_rng(seed)).frf
            found = sdypy_choice(frf)
            right += bool(np.all(np.abs(found / EIGHT_HZ - 1.0) < F_TOLERANCE))
            shown.append(found)
    except ModuleNotFoundError:
        print("sdypy-EMA is not installed: pip install '.[bench]' for the comparison")
        return
    print(f"sdypy-EMA, given the true frequencies: {right} of {len(SEEDS)} seeds right")
    for seed in range(3):
        print(f"  seed {seed}: {np.round(shown[seed], 1)}")


if __name__ == "__main__":
    main()
