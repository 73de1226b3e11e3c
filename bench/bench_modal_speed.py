"""Time from FRFs to poles, automatic choice and shapes, beside sdypy-EMA in one run.

sdypy-EMA's choice wants approximate frequencies: it is given the true ones. A long record is ten
FRFs of 16385 lines with 37 lightly damped modes, its whole band, nothing told of noise or place:
spread over the band, or placed at random, so that some stand within a line or two of one another.
"""

import os
import sys
import time
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.simulated_frfs import modal_frf, noisy_record, poles_of

from armodal.analyzer.modal import fit_modes
from armodal.protocols.frf_records import FrequencyResponse, FrfForm

REPEATS = 5
LONG_SEEDS = range(3)
CROWDED_SEEDS = range(8)
MODES_HZ = np.array([150.0, 420.0, 433.0, 800.0, 1250.0, 1900.0, 2500.0, 3100.0, 3900.0, 4500.0])


def made(n_resp: int, n_ref: int, n_lines: int) -> FrequencyResponse:
    """Ten modes, one close pair, 1 % noise, lines 1 Hz apart."""
    rng = np.random.default_rng(1)
    poles = poles_of(MODES_HZ, rng.uniform(0.005, 0.015, MODES_HZ.size))
    shapes = rng.standard_normal((poles.size, n_resp, 1))
    participation = rng.uniform(0.3, 1.0, (poles.size, 1, n_ref))
    participation *= rng.choice([-1.0, 1.0], participation.shape)
    residues = shapes * participation / (2j * poles.imag[:, None, None])
    freq = np.arange(1.0, n_lines + 1.0)
    clean = modal_frf(poles, residues, freq, FrfForm.ACCELERANCE)
    return noisy_record(rng, clean, freq, form=FrfForm.ACCELERANCE, level=0.01)


def long_record(seed: int, *, crowded: bool) -> tuple[FrequencyResponse, np.ndarray, np.ndarray]:
    """Ten FRFs of 16385 lines 0.5 Hz apart; frequencies and half bandwidths of their 37 modes."""
    rng = np.random.default_rng([7, seed] if crowded else seed)
    spread = np.linspace(0.0, 1.0, 37)
    at = rng.uniform(0.0, 1.0, 37) if crowded else spread + rng.uniform(-0.3, 0.3, 37) / 37
    f_hz = np.sort(20.0 * 400.0**at)
    damping = rng.uniform(0.001, 0.01, f_hz.size)
    poles = poles_of(f_hz, damping)
    shapes = rng.standard_normal((f_hz.size, 10, 1)) * rng.uniform(0.3, 1.0, (f_hz.size, 1, 1))
    freq = np.arange(1, 16386) * 0.5
    clean = modal_frf(poles, shapes / (2j * poles.imag[:, None, None]), freq, FrfForm.ACCELERANCE)
    frf = noisy_record(rng, clean, freq, form=FrfForm.ACCELERANCE, level=0.01)
    untold = replace(frf, variance=np.zeros(frf.values.shape))
    return untold, f_hz, damping * f_hz


def long_records(seeds: range, *, crowded: bool) -> None:
    for seed in seeds:
        frf, f_hz, half_hz = long_record(seed, crowded=crowded)
        began = time.process_time()
        model = fit_modes(frf)
        taken = time.process_time() - began
        apart = np.abs(model.f_hz[:, None] - f_hz)
        reach = np.maximum(half_hz, 0.5)
        missing = f_hz[(apart >= reach).all(axis=0)]
        extra = int(np.sum((apart >= reach).all(axis=1)))
        print(
            f"10 x 16385, {'at random' if crowded else 'spread'}, seed {seed}: armodal "
            f"{taken:.1f} s, at most 10 s wanted; "
            f"{f_hz.size - missing.size} of {f_hz.size} modes, {extra} beside; missing "
            f"{np.round(missing, 1).tolist()}"
        )


def median_cpu_s(task) -> float:
    """Processor time of one thread, median over repeats: the machine may be shared."""
    taken = []
    for _ in range(REPEATS):
        began = time.process_time()
        task()
        taken.append(time.process_time() - began)
    return float(np.median(taken))


def sdypy_fit(frf: FrequencyResponse):
    from sdypy import EMA  # noqa: PLC0415 - slow to import, and not timed

    freq = np.concatenate([[0.0], frf.freq_hz, [2 * frf.freq_hz[-1] - frf.freq_hz[-2]]])
    values = np.pad(frf.values[:, 0], ((0, 0), (1, 1)))  # it drops the last line

    def fit() -> None:
        model = EMA.Model(
            values,
            freq,
            lower=frf.freq_hz[0],
            upper=freq[-1],
            pol_order_high=60,
            frf_form="accelerance",
        )
        model.get_poles(show_progress=False)
        model.select_closest_poles(list(MODES_HZ))
        model.get_constants()

    return fit


def main() -> None:
    frf = made(60, 1, 4999)
    ours = median_cpu_s(lambda: fit_modes(frf, max_order=60))
    model = fit_modes(frf, max_order=60)
    print(f"60 x 4999, order 60: armodal {ours:.3f} s, {len(model.modes)} of {MODES_HZ.size} modes")
    try:
        theirs = median_cpu_s(sdypy_fit(frf))
    except ModuleNotFoundError:
        print("  sdypy-EMA is not installed: pip install '.[bench]' for the comparison")
    else:
        print(f"  sdypy-EMA {theirs:.3f} s; ratio {ours / theirs:.2f}, at most 0.50 wanted")
    long_records(LONG_SEEDS, crowded=False)
    long_records(CROWDED_SEEDS, crowded=True)
    several = made(60, 3, 5000)
    taken = median_cpu_s(lambda: fit_modes(several, max_order=60))
    print(f"3 references x 60 x 5000: armodal {taken:.3f} s, under 1 s wanted")


if __name__ == "__main__":
    main()
