"""Modes of measurements made by others, beside their published or line-fit references.

Read in place from `ARMODAL_DATA`, or `shared/data` beside the repository; nothing of them is here.
"""

import os
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import scipy.io

from armodal.analyzer.modal import drift_told, fit_modes
from armodal.analyzer.time_order import in_time_order
from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfForm

HERE = Path(__file__).resolve().parents[1]
DATA = Path(os.environ.get("ARMODAL_DATA", HERE.parent / "shared" / "data"))

# Line fits of each file's own FRF; sdypy-EMA 0.31; Slavic et al., vibration_toolbox.
BEAM_HZ = (111.994, 306.853, 596.366, 974.136)
ACCELERANCE_HZ = (51.52, 142.18, 278.66, 460.40, 687.17, 958.54)
ANALYSER_HZ = (192.5938,)


def frf_of(freq, values, form, coherence=None) -> FrequencyResponse:
    kept = freq > 0.0
    values = values[:, None, kept]
    coherence = np.full(values.shape, np.nan) if coherence is None else coherence[:, None, kept]
    z = np.array([0.0, 0.0, 1.0])
    n = values.shape[0]
    return FrequencyResponse(
        posture="structure",
        form=form,
        freq_hz=freq[kept],
        decay_rad_s=0.0,
        values=values,
        coherence=coherence,
        variance=np.full(values.shape, np.nan),
        n_hits=np.ones(values.shape[:2], dtype=np.int64),
        responses=tuple(Dof(point=str(i + 1), label="z", direction=z) for i in range(n)),
        references=(Dof(point="hammer", label="z", direction=z),),
        joints_rad=None,
    )


def told(name: str, frf: FrequencyResponse, band, reference_hz) -> None:
    began = time.process_time()
    model = fit_modes(frf, band_hz=band)
    taken = time.process_time() - began
    wanted = [f for f in reference_hz if model.band_hz[0] < f < model.band_hz[1]]
    print(f"{name}, {model.band_hz[0]:.0f} to {model.band_hz[1]:.0f} Hz, {taken:.1f} s:")
    near = {}
    for f_hz in wanted:
        off = np.abs(model.f_hz - f_hz) if model.modes else np.array([np.inf])
        near[int(np.argmin(off))] = f_hz
    for i, mode in enumerate(model.modes):
        beside = "beside the reference"
        if i in near:
            off = (mode.f_hz - near[i]) / mode.f_std_hz
            beside = f"reference {near[i]:.3f}, {off:+.1f} deviations"
        print(
            f"  {mode.f_hz:.3f} +- {mode.f_std_hz:.3f} Hz, {100 * mode.damping_ratio:.4f} +- "
            f"{100 * mode.damping_std:.4f} %, MPC {mode.mpc:.4f}; {beside}"
        )
    for drift in drift_told(model):
        print(f"  moves {drift.half_power_bandwidths:.2f} half-power bandwidths: {drift.cause}")
    print(
        f"  {len(near)} of {len(wanted)} found, {len(model.modes) - len(near)} beside", flush=True
    )


def main() -> None:
    folder = DATA / "beam_9_files"
    rows = [
        np.loadtxt(folder / f"Hxysv0000{i}.txt", encoding="latin-1", skiprows=9)
        for i in range(1, 10)
    ]
    # Their headers say (m/s²)/N; the folder's README calls them mobilities.
    beam = frf_of(
        rows[0][:, 0], np.array([r[:, 1] + 1j * r[:, 2] for r in rows]), FrfForm.ACCELERANCE
    )
    for band in ((50.0, 200.0), (200.0, 400.0), (500.0, 700.0), (900.0, 999.0), None):
        told("beam, nine files", beam, band, BEAM_HZ)
    columns = [np.loadtxt(DATA / "accelerance_3pt" / f"p{i}.txt", dtype=complex) for i in (1, 2, 3)]
    three = frf_of(np.arange(columns[0].size) * 1.0, np.array(columns), FrfForm.ACCELERANCE)
    told("three accelerances", three, None, ACCELERANCE_HZ)
    whole = scipy.io.loadmat(DATA / "analyser_mat" / "case2.mat")
    analyser, _ = in_time_order(
        frf_of(whole["Freq_domain"].ravel(), whole["Hf_chan_2"].reshape(1, -1), FrfForm.ACCELERANCE)
    )
    for band in ((150.0, 250.0), (50.0, 400.0), None):
        told("an analyser's beam", analyser, band, ANALYSER_HZ)


if __name__ == "__main__":
    main()
