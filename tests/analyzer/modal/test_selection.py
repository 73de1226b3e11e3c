"""Poles refined together: each stays with its own resonance."""

import numpy as np
from support.simulated_frfs import modal_frf, poles_of

from armodal.analyzer.modal.refine import refine_poles
from armodal.analyzer.modal.regression import modal_data
from armodal.analyzer.modal.selection import keep_modes, second_poles, select_modes
from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.frf_records import FrfForm

FREQ = 0.25 * np.arange(1800, 2801)
F_HZ = np.array([527.0, 533.5, 536.2, 571.2])
DAMPING = np.array([0.0019, 0.002, 0.0018, 0.002])


def crowd(rng, faint):
    """Three strong modes and a faint one, all weighted alike."""
    poles = poles_of(F_HZ, DAMPING)
    sizes = np.array([1.0, 3.0, 0.8, faint])
    shapes = (
        sizes[:, None, None] * rng.standard_normal((4, 12, 1)) / (2j * poles.imag[:, None, None])
    )
    values = modal_frf(poles, shapes, FREQ, FrfForm.ACCELERANCE)[:, 0]
    level = 1e-6 * np.mean(np.abs(values) ** 2)
    return poles, modal_data(
        FrfForm.ACCELERANCE, laplace_lines(FREQ, 0.0), values, np.full(values.shape, level)
    )


def test_a_faint_pole_does_not_leave_its_resonance_for_a_misfit_elsewhere():
    poles, data = crowd(np.random.default_rng(1), faint=0.01)
    given = poles[[0, 1, 3]]  # one of the strong ones was missed
    half = -poles[3].real
    # Left to itself the faint pole makes up for the missed mode.
    assert np.min(np.abs(refine_poles(data, given).poles - poles[3])) > 6.0 * half
    kept = keep_modes(data, given, np.ones(3), line_share=1.0)
    assert kept.held.tolist() == [False, False, True]
    assert abs(kept.fit.poles[2] - poles[3]) < half


def test_poles_come_back_by_frequency_with_what_they_were():
    poles, data = crowd(np.random.default_rng(2), faint=0.5)
    order = np.array([3, 0, 2, 1])
    kept = keep_modes(data, poles[order], np.arange(4.0), line_share=1.0)
    assert order[kept.given].tolist() == [0, 1, 2, 3]
    assert np.array_equal(kept.share, kept.given)
    assert np.allclose(kept.fit.poles, poles, rtol=1e-6)
    assert not kept.held.any()


def test_a_second_pole_is_found_beside_two_taken_for_one_and_beside_none_else():
    poles = poles_of([500.0, 527.0, 527.9], [0.002, 0.0019, 0.0019])
    rng = np.random.default_rng(3)
    shapes = rng.standard_normal((3, 12, 1)) / (2j * poles.imag[:, None, None])
    values = modal_frf(poles, shapes, FREQ, FrfForm.ACCELERANCE)[:, 0]
    level = 1e-6 * np.mean(np.abs(values) ** 2)
    noise = np.array([1.0, 1.0j]) @ rng.standard_normal((12, 2, FREQ.size))
    data = modal_data(
        FrfForm.ACCELERANCE,
        laplace_lines(FREQ, 0.0),
        values + np.sqrt(level / 2.0) * noise,
        np.full(values.shape, level),
    )
    one = refine_poles(data, poles[:2])
    tried = [pole - 0.6j * pole.real for pole in one.poles]
    (second,) = second_poles(data, one, tried, 1.0)
    assert np.min(np.abs(second - poles[1:])) < -poles[1].real
    complete = refine_poles(data, poles)
    assert not second_poles(
        data, complete, list(complete.poles - 0.6j * complete.poles.real), 1.0
    ).size


def test_two_modes_outside_the_lines_are_dropped_together():
    inside, outside = poles_of([527.0], [0.002]), poles_of([725.0, 735.0], [0.01, 0.01])
    poles = np.append(inside, outside)  # the lines end at 700 Hz
    rng = np.random.default_rng(5)
    shapes = rng.standard_normal((3, 12, 1)) / (2j * poles.imag[:, None, None])
    values = modal_frf(poles, shapes, FREQ, FrfForm.ACCELERANCE)[:, 0]
    data = modal_data(
        FrfForm.ACCELERANCE, laplace_lines(FREQ, 0.0), values, np.full(values.shape, 1e-4)
    )
    chosen = select_modes(data, poles, np.ones(3), (450.0, 700.0), line_share=1.0)
    assert np.allclose(chosen.fit.poles, inside, rtol=1e-3)
