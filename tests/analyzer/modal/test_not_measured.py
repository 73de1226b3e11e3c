"""FRF matrices of which not all was measured."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t as student
from support.drifting import TWO_HZ, drifting
from support.several_references import several_references, without
from support.simulated_frfs import eight_modes

from armodal.analyzer.modal import (
    cmif,
    fit_modes,
    mass_scaling,
    missing_mode_hints,
    multivariate_mif,
    synthesise,
    tracked_cmif,
)
from armodal.analyzer.modal.complete_parts import complete_block, complete_parts, linked
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrfForm

NO_DIAGONAL = {"n_points": 3, "at": (0, 1, 2)}


def inside(made):
    """Whether nominal 95 % intervals hold f, damping, shape and modal mass: four lists."""
    model = fit_modes(made.frf)
    if len(model.modes) != made.poles.size:
        return None
    found = ([], [], [], [])
    for mode, mass, pole, phi in zip(
        model.modes, mass_scaling(model), made.poles, made.shapes.T, strict=True
    ):
        reach, shape_reach = (student.ppf(0.975, dof) for dof in (mode.dof, mode.shape_dof))
        found[0].append(abs(mode.f_hz - abs(pole) / (2 * np.pi)) < reach * mode.f_std_hz)
        found[1].append(abs(mode.damping_ratio + pole.real / abs(pole)) < reach * mode.damping_std)
        largest = int(np.argmax(np.abs(mode.shape)))
        other = np.arange(phi.size) != largest
        error = np.abs(mode.shape.real - phi / phi[largest])
        found[2].extend((error < shape_reach * mode.shape_std.real)[other])
        true_kg = 1.0 / phi[largest] ** 2
        found[3].append(abs(mass.modal_mass_kg - true_kg) < shape_reach * mass.modal_mass_std_kg)
    return found


def covered(seeds, **how):
    """Shares of intervals that hold the truth, and of seeds in which every mode was found."""
    all_found = [inside(several_references(np.random.default_rng(seed), **how)) for seed in seeds]
    whole = [found for found in all_found if found is not None]
    shares = [np.mean(np.concatenate(part)) for part in zip(*whole, strict=True)]
    return shares, len(whole) / len(all_found)


def test_three_references_without_driving_points_give_modes_and_masses():
    made = several_references(np.random.default_rng(0))
    model = fit_modes(made.frf)
    assert len(model.modes) == 4
    assert any("3 of 36 FRFs were not measured" in note for note in model.notes)
    assert np.array_equal(np.isnan(model.frac), ~made.frf.measured)
    assert missing_mode_hints(made.frf, model) == ()
    for mode, mass, true_kg in zip(
        model.modes, mass_scaling(model), made.modal_mass_kg, strict=True
    ):
        assert mass.point == "0"  # hit there, and not measured under that hit
        assert mass.consistent
        # Five deviations of some seven degrees of freedom: once in five hundred.
        assert abs(mass.modal_mass_kg - true_kg) < 5.0 * mass.modal_mass_std_kg
        assert mass.modal_mass_std_kg < 0.05 * true_kg
        assert mode.mpc > 0.99


@pytest.mark.long
@pytest.mark.parametrize("told", [True, False])
def test_intervals_cover_on_measured_scales(told):
    shares, whole = covered(range(100), told=told)
    assert whole >= 0.98
    # 400 intervals each, 4400 of shapes: the band that the intervals of all modal fits keep.
    assert all(0.90 <= share <= 0.99 for share in shares), shares


@pytest.mark.long
def test_intervals_cover_without_a_diagonal():
    shares, whole = covered(range(100), **NO_DIAGONAL)
    # Six FRFs, the least telling a thousandth of the most: a close mode may not be seen.
    assert whole >= 0.9
    assert all(0.90 <= share <= 0.99 for share in shares), shares


@pytest.mark.long
def test_a_matrix_without_its_diagonal_counts_six_frfs_not_nine():
    told = [
        fit_modes(several_references(np.random.default_rng(seed), **NO_DIAGONAL).frf).lack_of_fit
        for seed in range(5)
    ]
    # Six FRFs of 264 lines have 3100 degrees of freedom: 2.5 % a fit. Nine would give 0.67.
    assert np.mean(told) == pytest.approx(1.0, abs=0.05)


def test_what_stands_in_a_hole_is_not_looked_at():
    frf = several_references(np.random.default_rng(1)).frf
    values = np.where(frf.measured[..., None], frf.values, 1e6 * (1.0 + 1.0j))
    clean, dirty = fit_modes(frf), fit_modes(replace(frf, values=values))
    assert np.array_equal(clean.f_hz, dirty.f_hz)
    assert np.array_equal(clean.covariance, dirty.covariance)


@pytest.mark.long
def test_holes_widen_the_deviations_and_move_nothing_else():
    rng = np.random.default_rng(5)
    whole = eight_modes(rng, n_resp=12, n_ref=3).frf
    measured = rng.random(whole.values.shape[:2]) > 0.3
    measured[0] = True
    full, part = fit_modes(whole), fit_modes(without(whole, measured))
    assert len(part.modes) == len(full.modes) == 8
    std = np.array([mode.f_std_hz for mode in part.modes])
    # Both hold the same FRFs: they differ by what the holes' FRFs brought, less than all of it.
    assert np.all(np.abs(part.f_hz - full.f_hz) < 3.0 * std)
    assert np.median(std / [mode.f_std_hz for mode in full.modes]) > 1.0


def test_the_model_tells_an_frf_that_was_not_measured():
    made = several_references(np.random.default_rng(2))
    model = fit_modes(made.frf)
    told = synthesise(model, made.frf.freq_hz)
    s = 2j * np.pi * made.frf.freq_hz
    quadratics = (s - made.poles[:, None]) * (s - made.poles.conj()[:, None])
    true = np.sum(made.shapes[0, :, None] ** 2 / quadratics, axis=0) * s**2
    # Residues there are known to some per cent: see the modal masses.
    assert np.all(np.abs(told[0, 0] - true) < 0.05 * np.abs(true).max())


@pytest.mark.long
def test_a_roving_hammer_may_leave_out_driving_points():
    made = several_references(np.random.default_rng(3))
    frf = made.frf
    turned = replace(
        frf,
        values=frf.values.swapaxes(0, 1),
        variance=frf.variance.swapaxes(0, 1),
        coherence=frf.coherence.swapaxes(0, 1),
        n_hits=frf.n_hits.T,
        responses=frf.references,
        references=frf.responses,
    )
    one, other = fit_modes(frf), fit_modes(turned)
    assert np.allclose(one.f_hz, other.f_hz, rtol=1e-9)  # the same sums in another order
    assert np.allclose(
        [mass.modal_mass_kg for mass in mass_scaling(one)],
        [mass.modal_mass_kg for mass in mass_scaling(other)],
        rtol=1e-3,  # the driving point of one is that with the largest hit, of the other any
    )


@pytest.mark.long
def test_moving_modes_are_told_where_an_frf_is_missing():
    made = drifting(np.random.default_rng(4), 1.0, nominal_hz=TWO_HZ)
    measured = np.ones(made.frf.values.shape[:2], dtype=bool)
    measured[[1, 5, 9]] = False  # one axis of three mountings; of one reference each must drop out
    rows = np.flatnonzero(measured[:, 0])
    twice = replace(
        made.frf,
        values=np.concatenate([made.frf.values, made.frf.values], axis=1),
        variance=np.concatenate([made.frf.variance, made.frf.variance], axis=1),
        coherence=np.concatenate([made.frf.coherence, made.frf.coherence], axis=1),
        n_hits=np.concatenate([made.frf.n_hits, made.frf.n_hits], axis=1),
        references=made.frf.references * 2,
    )
    both = np.ones((measured.shape[0], 2), dtype=bool)
    both[:, 1] = measured[:, 0]
    model = fit_modes(without(twice, both))
    assert rows.size == 21
    assert len(model.modes) == made.still_hz.size
    assert all(mode.drift is not None for mode in model.modes)


def test_indicators_take_the_complete_block():
    made = several_references(np.random.default_rng(6))
    frf = made.frf
    line = int(np.argmin(np.abs(frf.freq_hz - 17.0)))
    curves = cmif(frf)
    assert curves.shape == (frf.freq_hz.size, 3)
    # A mode alone has one singular value: a hole taken for 0 would give it another.
    assert curves[line, 1] < 0.1 * curves[line, 0]
    assert tracked_cmif(frf).left.shape[1] == 9
    assert multivariate_mif(frf).shape == (frf.freq_hz.size, 3)


def test_a_block_without_holes_is_found():
    measured = np.ones((12, 3), dtype=bool)
    measured[[0, 4, 8], [0, 1, 2]] = False
    rows, columns = complete_block(measured)
    assert rows.size == 9
    assert columns.size == 3
    index = np.arange(36).reshape(12, 3)
    block, single = (index[part] for part in complete_parts(measured))
    assert block.shape == (9, 3)
    assert single.shape == (33, 1)
    assert set(single.ravel()) == set(index[measured])


def test_responses_are_linked_by_the_references_they_share():
    chain = np.array([[1, 0, 0], [1, 1, 0], [0, 1, 1], [0, 0, 1]], dtype=bool)
    assert linked(chain).all()
    assert linked(chain[[0, 1, 3]]).tolist() == [True, True, False]


@pytest.mark.parametrize(
    ("holes", "wanted"),
    [
        ([(0, 0), (0, 1), (0, 2)], "no FRF of 0 z was measured"),
        ([(i, 0) for i in range(12)], "no FRF of 0 hit was measured"),
        (
            [(i, 0) for i in range(6)] + [(i, j) for i in range(6, 12) for j in (1, 2)],
            "share references; 6 z and 0 z have none in common",
        ),
    ],
)
def test_frfs_that_no_shape_joins_are_refused(holes, wanted):
    frf = several_references(np.random.default_rng(7)).frf
    measured = np.ones(frf.values.shape[:2], dtype=bool)
    measured[tuple(np.array(holes).T)] = False
    with pytest.raises(EstimateError, match=wanted):
        fit_modes(without(frf, measured))


@pytest.mark.long
def test_receptances_are_fitted_alike():
    made = several_references(np.random.default_rng(8))
    s2 = (2j * np.pi * made.frf.freq_hz) ** 2
    with np.errstate(invalid="ignore"):
        receptance = replace(
            made.frf,
            form=FrfForm.RECEPTANCE,
            values=made.frf.values / s2,
            variance=made.frf.variance / np.abs(s2) ** 2,
        )
    # Modal masses do not know what the response was measured as.
    for one, other in zip(
        mass_scaling(fit_modes(made.frf)), mass_scaling(fit_modes(receptance)), strict=True
    ):
        both = np.hypot(one.modal_mass_std_kg, other.modal_mass_std_kg)
        assert abs(one.modal_mass_kg - other.modal_mass_kg) < both
