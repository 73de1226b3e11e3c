import dataclasses

import numpy as np
import pytest
from scipy import optimize
from support import hammer
from support.quick import few_quick
from support.simulated_frfs import modal_frf, poles_of

from armodal.analyzer.modal import (
    band_of_hits,
    fit_modes,
    hit_frfs,
    hit_spectra,
    posture_frf,
    record_notes,
)
from armodal.analyzer.modal.spectra import active_channels
from armodal.analyzer.modal.usable_band import usable_band
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrfForm
from armodal.protocols.plan_records import Mode

POLES = poles_of([11.0, 38.0, 79.0], [0.03, 0.025, 0.02])


def residues(rng, n_points):
    return 0.3 * rng.standard_normal((3, n_points, 3)) / (2j * POLES.imag[:, None, None])


def axes(_point):
    return np.eye(3)


def relative_error(frf, R):
    truth = modal_frf(POLES, R.reshape(3, -1, 1), frf.freq_hz, FrfForm.ACCELERANCE, frf.decay_rad_s)
    return np.sqrt(np.sum(np.abs(frf.values - truth) ** 2) / np.sum(np.abs(truth) ** 2))


# Sampled fast enough that the half-sine aliases below 1e-4 of its spectrum in the band.
FAST = {"rate": 16384, "samples": 32768}


@pytest.mark.parametrize(
    ("force_s", "corner_hz"),
    [
        (None, 0.0),
        pytest.param(None, 0.5, marks=pytest.mark.long),
        pytest.param(0.02, 0.0, marks=pytest.mark.long),
        (0.02, 0.5),
    ],
)
def test_windowed_frf_is_the_transfer_function_on_the_shifted_line(corner_hz, force_s):
    rng = np.random.default_rng(1)
    R = residues(rng, 2)
    session = hammer.session(
        POLES, R, rng=rng, corner_hz=corner_hz, force_s=force_s, exponential_end=0.001, **FAST
    )
    frf = posture_frf(session, "p", axes, band_hz=(3.0, 150.0))
    assert frf.decay_rad_s == pytest.approx(-np.log(0.001) * np.diff(frf.freq_hz)[0])
    # Left at the end: e^(-(a + zeta w) T) = 0.001 * e^-4.1; the rest is aliasing and the
    # trapezoidal rule, each of order 1e-3 at 3 ms pulses.
    assert relative_error(frf, R) < 3e-3


@pytest.mark.parametrize("end", few_quick([0.3, 0.03, 0.003], 0.003))
def test_damping_comes_out_without_correction_for_the_window(end):
    rng = np.random.default_rng(2)
    R = residues(rng, 3)
    session = hammer.session(POLES, R, rng=rng, exponential_end=end, **FAST)
    model = fit_modes(posture_frf(session, "p", axes, band_hz=(3.0, 150.0)))
    # A window of this size would add up to 0.04 to the lowest mode's damping ratio.
    np.testing.assert_allclose(model.damping_ratio, -POLES.real / np.abs(POLES), rtol=2e-3)
    np.testing.assert_allclose(model.f_hz, [11.0, 38.0, 79.0], rtol=1e-4)


def test_roving_response_orders_three_axes_a_point_over_one_reference():
    rng = np.random.default_rng(3)
    frf = posture_frf(hammer.session(POLES, residues(rng, 4), rng=rng), "p", axes)
    assert frf.values.shape[:2] == (12, 1)
    assert [(d.point, d.label) for d in frf.responses[:4]] == [
        ("1", "x"),
        ("1", "y"),
        ("1", "z"),
        ("2", "x"),
    ]
    assert frf.references[0].point == "7"
    np.testing.assert_allclose(frf.joints_rad, [0.1, 0.2])
    assert np.all(frf.n_hits == 3)


def test_roving_hammer_has_the_fixed_sensors_axes_as_responses():
    rng = np.random.default_rng(4)
    R = residues(rng, 5)
    session = hammer.session(POLES, R, rng=rng, mode=Mode.ROVING_HAMMER)
    frf = posture_frf(session, "p", axes)
    assert frf.values.shape[:2] == (3, 5)
    assert [d.point for d in frf.references] == ["1", "2", "3", "4", "5"]
    assert {d.point for d in frf.responses} == {"7"}
    same = posture_frf(hammer.session(POLES, R, rng=np.random.default_rng(4)), "p", axes)
    assert same.responses[0].point == "1"


@pytest.mark.long
def test_stated_variance_is_that_of_repeated_sessions():
    rng = np.random.default_rng(5)
    R = residues(rng, 4)
    runs = [
        posture_frf(hammer.session(POLES, R, rng=rng, noise=0.5), "p", axes, band_hz=(5.0, 200.0))
        for _ in range(24)
    ]
    values = np.stack([frf.values for frf in runs])
    observed = np.var(values, axis=0, ddof=1).mean(axis=-1)
    stated = np.mean([frf.variance for frf in runs], axis=0).mean(axis=-1)
    ratio = stated / observed
    # 24 runs of some hundred correlated lines: 7 % scatter; the hits' levels and widths differ
    # from run to run, and the floor keeps the estimate a little above.
    assert 0.8 < np.median(ratio) < 1.6


def test_coherence_is_one_without_noise_and_falls_with_it():
    rng = np.random.default_rng(6)
    R = residues(rng, 2)
    clean = posture_frf(hammer.session(POLES, R, rng=rng, **FAST), "p", axes, band_hz=(3.0, 150.0))
    noisy = posture_frf(hammer.session(POLES, R, rng=rng, noise=5.0), "p", axes)
    # Counts and aliasing are the only noise; they show in the antiresonances.
    assert clean.coherence.min() > 0.99
    assert np.all((noisy.coherence >= 0.0) & (noisy.coherence <= 1.0))
    assert noisy.coherence.mean() < clean.coherence.mean()


def test_single_hits_average_to_the_posture_frf():
    rng = np.random.default_rng(7)
    session = hammer.session(POLES, residues(rng, 1), rng=rng, noise=0.1)
    spectra = hit_spectra(session, session.accepted("p"))
    single = hit_frfs(spectra)
    power = np.abs(spectra.force[:, None]) ** 2
    weighted = (single * power).sum(axis=0) / power.sum(axis=0)
    frf = posture_frf(session, "p", axes)
    np.testing.assert_allclose(frf.values[:, 0], weighted, rtol=1e-10)  # rounding of two sums


@pytest.mark.parametrize("width_s", [2.5e-3, 4e-3])
def test_lines_stop_where_the_hammer_gives_no_force(width_s):
    rng = np.random.default_rng(8)
    pulses = {"rate": 16384, "samples": 16384, "widths_s": (width_s, width_s)}
    frf = posture_frf(hammer.session(POLES, residues(rng, 1), rng=rng, **pulses), "p", axes)

    def left(freq_hz):
        """Of a half-sine's spectrum, beyond the two hundredths that are too little."""
        turns = freq_hz * width_s
        return np.abs(np.cos(np.pi * turns) / (1.0 - 4.0 * turns**2)) - 0.02

    edge_hz = optimize.brentq(left, 0.6 / width_s, 1.5 / width_s)  # its first zero
    # A line less, and one for the shift of the lines and for aliasing.
    assert edge_hz - 2.0 < frf.freq_hz[-1] < edge_hz + 1.0


def test_a_hit_without_any_force_is_refused_by_its_number():
    session = hammer.session(POLES, residues(np.random.default_rng(9), 1))
    force, *_ = active_channels(session)[2]
    first, *others = session.hits
    counts = first.counts.copy()
    counts[:, force] = 7  # an offset is no force
    dead = dataclasses.replace(session, hits=(dataclasses.replace(first, counts=counts), *others))
    with pytest.raises(EstimateError, match=rf"hit {first.number} of posture 'p': .* got none"):
        posture_frf(dead, "p", axes)


@pytest.mark.parametrize("missing", [1, 2, 3])
def test_a_channel_that_was_not_recorded_has_no_column(missing):
    """The mask tells which of the dictionary's channels the counts hold, bit 0 the first."""
    session = hammer.session(POLES, residues(np.random.default_rng(9), 1))
    channels = session.header.dictionary.channels
    mask = (1 << len(channels)) - 1 - (1 << missing)
    header = dataclasses.replace(session.header, channel_mask=mask)
    force, acceleration, columns = active_channels(dataclasses.replace(session, header=header))
    assert force == channels[0]
    assert acceleration == tuple(c for i, c in enumerate(channels) if i not in {0, missing})
    assert columns == [0, 1, 2]


def test_a_posture_without_hits_is_refused():
    session = hammer.session(POLES, residues(np.random.default_rng(9), 1))
    with pytest.raises(EstimateError, match="no accepted hits"):
        posture_frf(session, "q", axes)


def test_a_point_without_directions_is_named():
    session = hammer.session(POLES, residues(np.random.default_rng(9), 2))
    with pytest.raises(EstimateError, match="point '2'"):
        posture_frf(session, "p", {"1": np.eye(3)})


def test_hits_of_unequal_length_are_refused():
    session = hammer.session(POLES, residues(np.random.default_rng(9), 1))
    short = dataclasses.replace(session.hits[0], counts=session.hits[0].counts[:100])
    with pytest.raises(EstimateError, match="hit 1 has 100 samples"):
        posture_frf(dataclasses.replace(session, hits=(short, *session.hits[1:])), "p", axes)


def test_records_one_sample_apart_are_cut_to_the_shortest_with_a_word():
    session = hammer.session(POLES, residues(np.random.default_rng(9), 1))
    whole = [dataclasses.replace(h, counts=h.counts[:-1]) for h in session.hits]
    # One record ends a sample earlier, another begins a sample later.
    later = dataclasses.replace(
        whole[1], counts=session.hits[1].counts[1:-1], first_sample=whole[1].first_sample + 1
    )
    apart = dataclasses.replace(session, hits=(session.hits[0], later, *whole[2:]))
    alike = dataclasses.replace(session, hits=tuple(whole))
    got, wanted = (posture_frf(s, "p", axes).values for s in (apart, alike))
    # The mean before the trigger is taken over a sample less: within the noise of 100 samples.
    np.testing.assert_allclose(got, wanted, atol=1e-4 * np.abs(wanted).max())
    assert any("samples from the trigger on" in note for note in record_notes(apart, "p"))
    assert not any("samples from the trigger" in note for note in record_notes(alike, "p"))


def test_a_reversed_hammer_gives_the_frf_of_a_push_along_the_hit():
    session = hammer.session(POLES, residues(np.random.default_rng(10), 1), noise=1e-3)
    turned = []
    for hit in session.hits:
        counts = hit.counts.copy()
        counts[:, 0] *= -1
        verdict = dataclasses.replace(hit.verdict, polarity=-1)
        # The board triggered on what came after the pulse.
        late = hit.trigger_sample + 20
        turned.append(dataclasses.replace(hit, counts=counts, verdict=verdict, trigger_sample=late))
    got = posture_frf(dataclasses.replace(session, hits=tuple(turned)), "p", axes)
    wanted = posture_frf(session, "p", axes)
    assert got.freq_hz.size == pytest.approx(wanted.freq_hz.size, rel=0.02)
    reference = np.interp(got.freq_hz, wanted.freq_hz, wanted.values[0, 0].real)
    share = np.sum(got.values[0, 0].real * reference) / np.sum(reference**2)
    assert share == pytest.approx(1.0, abs=0.02)  # lines lie otherwise: interpolated between


def test_an_offset_of_the_force_ends_no_band():
    freq = np.arange(0.0, 500.0)
    force = np.where(freq < 200.0, 1.0, 0.01)[None]
    with_offset = force.copy()
    with_offset[0, :3] = 1e3  # 0 Hz, and what a short record leaks from it
    for given in (force, with_offset):
        assert usable_band(freq, given, 1000.0).high_hz == pytest.approx(200.0, rel=1e-9)


def test_a_long_record_has_lines_below_3_hz_whatever_its_force_drifts_by():
    freq = np.arange(0.0, 20.0, 1.0 / 180.0)
    force = np.ones((1, freq.size))
    force[0, freq < 0.5] = 1e3  # drift
    usable = usable_band(freq, force, 50.0)
    assert usable.low_hz == pytest.approx(16.0 / 180.0)
    assert usable.high_hz == pytest.approx(19.5)
    assert usable_band(np.arange(0.0, 500.0), np.ones((1, 500)), 1000.0).low_hz == 3.0


@pytest.mark.parametrize(
    ("seed", "samples"),
    [(12, 16384), *(pytest.param(seed, 65536, marks=pytest.mark.long) for seed in (12, 13, 14))],
)
def test_a_single_hit_triggered_at_once_still_has_its_modes(seed, samples):
    """Too few samples before the trigger to tell a noise, and no second hit: lines tell it."""
    rng = np.random.default_rng(seed)
    session = hammer.session(
        POLES,
        residues(rng, 4),
        hits=1,
        samples=samples,
        exponential_end=1.0,
        noise=0.3,
        rng=rng,
        widths_s=(2.5e-3, 2.5e-3),
    )
    cut = 90
    hits = tuple(
        dataclasses.replace(hit, counts=hit.counts[cut:], first_sample=hit.first_sample + cut)
        for hit in session.hits
    )
    frf = posture_frf(dataclasses.replace(session, hits=hits), "p", axes)
    model = fit_modes(frf)
    wanted = np.sort(np.abs(POLES)) / (2.0 * np.pi)
    found = np.array([np.abs(model.f_hz - f).min() for f in wanted])
    assert np.all(found < 0.02 * wanted)


def test_the_band_hits_excite_is_said_and_another_one_is_taken_with_a_warning():
    # A pulse of 4 ms has its spectrum's first zero near 375 Hz, and 2 % of its maximum there.
    session = hammer.session(POLES, residues(np.random.default_rng(11), 1), widths_s=(4e-3, 4e-3))
    usable = band_of_hits(session, "p")
    frf = posture_frf(session, "p", axes)
    assert usable.high_hz == pytest.approx(375.0, rel=0.05)
    assert frf.freq_hz[-1] <= usable.high_hz
    (said,) = record_notes(session, "p")
    assert f"{usable.high_hz:.5g} Hz" in said
    assert "--band" in said
    wide = usable.widened((3.0, 450.0))
    assert posture_frf(session, "p", axes, band_hz=wide).freq_hz[-1] > 449.0
    (warned,) = record_notes(session, "p", band_hz=(3.0, 450.0))
    assert "the force is below 2 %" in warned
    assert record_notes(session, "p", band_hz=(5.0, 100.0)) == ()
    assert record_notes(session, "p", ends_earlier=True) == ()
    assert usable.widened((5.0, 100.0)) is None


def test_a_mask_without_force_channel_is_refused():
    session = hammer.session(POLES, residues(np.random.default_rng(9), 1))
    header = dataclasses.replace(session.header, channel_mask=0b1110)
    with pytest.raises(EstimateError, match="one force channel"):
        posture_frf(dataclasses.replace(session, header=header), "p", axes)


def recorded(session, names):
    """The same test on a board with these acceleration channels, among acc_x, acc_y, acc_z."""
    old = [channel.name for channel in session.header.dictionary.channels]
    columns = [0, *(old.index(name) for name in names)]
    header = dataclasses.replace(
        session.header,
        dictionary=hammer.dictionary(names=("hammer", *names)),
        channel_mask=2 ** len(columns) - 1,
    )
    hits = tuple(dataclasses.replace(h, counts=h.counts[:, columns]) for h in session.hits)
    return dataclasses.replace(session, header=header, hits=hits)


@pytest.mark.parametrize(
    "names", [("acc_z", "acc_x", "acc_y"), ("acc_x", "acc_z"), ("acc_z",), ("acc_y", "acc_x")]
)
def test_a_channels_letter_tells_its_axis_whatever_the_order(names):
    rng = np.random.default_rng(10)
    session = hammer.session(POLES, residues(rng, 2), rng=rng)
    # Axes of a sensor that is turned at every point.
    turned = {"1": np.eye(3)[:, [1, 2, 0]], "2": np.diag([1.0, -1.0, -1.0])}
    whole = posture_frf(session, "p", turned)
    part = posture_frf(recorded(session, names), "p", turned)
    found = [(dof.point, dof.label) for dof in part.responses]
    assert found == [(p, axis) for p in "12" for axis in sorted(name[-1] for name in names)]
    rows = [(dof.point, dof.label) for dof in whole.responses]
    for i, dof in enumerate(part.responses):
        same = rows.index((dof.point, dof.label))
        np.testing.assert_array_equal(dof.direction, turned[dof.point][:, "xyz".index(dof.label)])
        np.testing.assert_array_equal(part.values[i], whole.values[same])


def test_three_channels_without_letters_are_x_y_z_in_order():
    session = hammer.session(POLES, residues(np.random.default_rng(11), 1))
    plain = hammer.dictionary(names=("hammer", "ch1", "ch2", "ch3"))
    header = dataclasses.replace(session.header, dictionary=plain)
    named = posture_frf(session, "p", axes)
    found = posture_frf(dataclasses.replace(session, header=header), "p", axes)
    assert [dof.label for dof in found.responses] == ["x", "y", "z"]
    np.testing.assert_array_equal(found.values, named.values)


@pytest.mark.parametrize(
    "names",
    [
        ("acc_x", "acc_y", "third"),  # one without a letter
        ("acc_x", "acc_y", "base_y"),  # one twice
        ("first", "second"),  # two of three, not told which
        ("acc",),
        ("acc_x", "acc_y", "acc_z", "base_x"),
    ],
)
def test_channels_that_do_not_tell_their_axis_are_refused_with_the_way_to_name_them(names):
    session = hammer.session(POLES, residues(np.random.default_rng(12), 1))
    header = dataclasses.replace(
        session.header,
        dictionary=hammer.dictionary(names=("hammer", *names)),
        channel_mask=2 ** (1 + len(names)) - 1,
    )
    columns = [0, 1, 2, 3, 1][: 1 + len(names)]
    hits = tuple(dataclasses.replace(h, counts=h.counts[:, columns]) for h in session.hits)
    with pytest.raises(EstimateError, match=r"names that end in x, y or z.*" + names[-1]):
        posture_frf(dataclasses.replace(session, header=header, hits=hits), "p", axes)
