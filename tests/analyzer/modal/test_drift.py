"""A mode that moves from mounting to mounting is one mode, and is told with its cause."""

import os
from pathlib import Path

import numpy as np
import pytest
from support.drifting import FOUR_HZ, TWO_HZ, drifting
from support.simulated_frfs import EIGHT_HZ, eight_modes, modal_frf, poles_of, record

from armodal.analyzer.modal import drift_told, fit_modes, synthesise
from armodal.analyzer.modal.drift import settle_drift
from armodal.analyzer.modal.regression import modal_data, regress
from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.frf_records import FrfForm

# Below a twentieth of a half-power bandwidth nothing can be seen to move; two are the most asked.
RANGES = (0.0, 0.1, 0.5, 1.0, 2.0)


@pytest.mark.parametrize(
    ("bandwidths", "by", "nominal_hz"),
    [
        (1.0, "sensor", TWO_HZ),
        *(
            pytest.param(bandwidths, by, FOUR_HZ, marks=pytest.mark.long)
            for bandwidths in RANGES
            for by in ("sensor", "batch")
        ),
    ],
)
def test_exactly_the_true_modes_are_found_at_the_mean_of_the_drift(bandwidths, by, nominal_hz):
    seed = np.random.SeedSequence([round(10 * bandwidths), len(by)])
    made = drifting(np.random.default_rng(seed), bandwidths, by=by, nominal_hz=nominal_hz)
    model = fit_modes(made.frf)
    assert len(model.modes) == made.still_hz.size
    mean = made.f_hz.mean(axis=0)
    std = np.array([mode.f_std_hz for mode in model.modes])
    # Of four modes one is beyond four deviations in some 4000 draws.
    assert np.all(np.abs(model.f_hz - mean) < 4.0 * std)
    # Without drift noise of 1 % leaves 1e-4 of it.
    assert min(mode.mpc for mode in model.modes) > 0.98


@pytest.mark.long
@pytest.mark.parametrize(("by", "cause"), [("sensor", "sensor mass"), ("batch", "order")])
def test_what_moves_a_mode_is_told_with_its_ends(by, cause):
    made = drifting(np.random.default_rng(5), 1.0, by=by)
    told = drift_told(fit_modes(made.frf))
    assert len(told) == made.still_hz.size
    rows = zip(told, made.f_hz.T, made.still_hz, made.damping, strict=True)
    for mode, f_hz, still, damping in rows:
        assert mode.cause.startswith(cause)
        # A mounting's frequency is known to some hundredths of a bandwidth.
        moved = np.ptp(f_hz) / (2.0 * damping * still)
        assert mode.half_power_bandwidths == pytest.approx(moved, abs=0.05)
        assert mode.lowest[1] == pytest.approx(f_hz.min(), rel=1e-3)
        assert mode.highest[1] == pytest.approx(f_hz.max(), rel=1e-3)
        assert mode.lowest[0] == str(int(np.argmin(f_hz)) + 1) or by == "batch"
        if by == "sensor":
            assert mode.f_without_sensor_hz == pytest.approx(still, rel=1e-3)


def test_the_synthesis_follows_each_mounting():
    made = drifting(np.random.default_rng(6), 2.0, nominal_hz=TWO_HZ)
    model = fit_modes(made.frf)
    left = made.frf.values - synthesise(model, made.frf.freq_hz)
    error = np.sqrt(np.sum(np.abs(left) ** 2) / np.sum(np.abs(made.frf.values) ** 2))
    assert error < 0.02  # noise is 1 %


def test_a_mounting_at_a_node_tells_nothing_of_that_mode_s_pole():
    """Where a mode is not seen, the best pole is one of the noise: it counts for nothing."""
    rng = np.random.default_rng(0)
    freq = np.arange(1, 800) * 0.25
    x, y = np.tile(np.linspace(0.0, 1.0, 5), 3), np.repeat(np.linspace(-1.0, 1.0, 3), 5)
    shapes = np.stack(
        [np.cos(np.pi * x), y * (2.0 * x - 1.0), np.cos(2.0 * np.pi * x)], axis=1
    )  # (points, modes)
    f_hz = np.array([40.0, 75.0, 130.0]) * (1.0 - 0.004 * shapes**2)  # as a sensor's mass does
    s, w = 2j * np.pi * freq, 2.0 * np.pi * f_hz[..., None]
    z = np.array([0.01, 0.006, 0.012])[:, None]
    clean = np.sum(s**2 * (shapes * shapes[0])[..., None] / (s**2 + 2 * z * w * s + w**2), axis=1)
    size = 0.01 * np.sqrt(np.mean(np.abs(clean) ** 2, axis=-1, keepdims=True) / 2.0)
    noise = rng.standard_normal((2, *clean.shape))
    model = fit_modes(record((clean + size * (noise[0] + 1j * noise[1]))[:, None, :], freq))
    sees = np.abs(shapes) > 1e-9
    wanted = [f_hz[sees[:, m], m].mean() for m in range(3)]
    # One that noise told as seen moved the first by 0.33 Hz, sixteen stated deviations.
    std = np.array([mode.f_std_hz for mode in model.modes])
    assert np.all(np.abs(model.f_hz - wanted) < np.maximum(2.0 * std, 0.005))


def test_nothing_moves_where_only_noise_does():
    for seed in range(3):
        model = fit_modes(drifting(np.random.default_rng([7, seed]), 0.0, nominal_hz=TWO_HZ).frf)
        assert drift_told(model) == ()


@pytest.mark.long
def test_two_modes_close_to_one_another_are_not_one_that_moves():
    """13 and 13.4 Hz, a half bandwidth apart, seen by thirty mountings of one axis."""
    for seed in range(3):
        made = eight_modes(np.random.default_rng([8, seed]), form=FrfForm.ACCELERANCE)
        model = fit_modes(made.frf)
        assert len(model.modes) == EIGHT_HZ.size
        assert drift_told(model) == ()


_ROOT = Path(__file__).resolve().parents[3]
DATA = Path(os.environ.get("ARMODAL_DATA", _ROOT.parent / "shared" / "data"))


@pytest.mark.long
@pytest.mark.skipif(not (DATA / "beam_9_files").is_dir(), reason="real measurements not here")
def test_a_measured_beam_has_four_modes_and_not_twelve():
    rows = [
        np.loadtxt(DATA / "beam_9_files" / f"Hxysv0000{i}.txt", encoding="latin-1", skiprows=9)
        for i in range(1, 10)
    ]
    values = np.array([row[1:, 1] + 1j * row[1:, 2] for row in rows])[:, None, :]
    frf = record(values, rows[0][1:, 0], form=FrfForm.MOBILITY)
    bands = {111.995: (50, 200), 306.854: (200, 400), 596.366: (500, 700), 974.135: (900, 999)}
    for f_hz, band in bands.items():
        model = fit_modes(frf, band_hz=band)
        (mode,) = model.modes
        # Line fits of each file lie within 0.1 Hz of one another around these.
        assert mode.f_hz == pytest.approx(f_hz, abs=3.0 * mode.f_std_hz)
        assert mode.mpc > 0.98
        (told,) = drift_told(model)
        assert told.half_power_bandwidths > 0.2


def test_resonances_seen_at_other_points_are_not_one_that_moves():
    rng = np.random.default_rng(8)
    freq = 0.05 * np.arange(1400, 3301)
    poles = poles_of([100.0, 130.0], [0.01, 0.01])
    shapes = rng.standard_normal((2, 8, 1)) / (2j * poles.imag[:, None, None])
    shapes[0, 4:], shapes[1, :4] = 0.0, 0.0  # each at half of the points alone
    clean = modal_frf(poles, shapes, freq, FrfForm.ACCELERANCE)
    noise = 1e-3 * np.abs(clean).max()
    noisy = clean + noise * (rng.normal(size=clean.shape) + 1j * rng.normal(size=clean.shape))
    data = modal_data(
        FrfForm.ACCELERANCE, laplace_lines(freq, 0.0), noisy, np.full(clean.shape, 2.0 * noise**2)
    )
    between = poles_of([115.0], [2.0 / 115.0])  # as a fit of too few poles has it
    fit = regress(data, between)
    assert settle_drift(data, fit, np.arange(8), line_share=1.0, searched=True) is None
