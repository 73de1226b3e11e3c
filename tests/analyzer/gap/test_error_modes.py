"""Errors of a right model, learnt from what a fit leaves."""

import numpy as np
import pytest

from armodal.analyzer.gap.inference.error_modes import (
    Sensitivities,
    curvature_of,
    error_slopes,
    opposed,
    released,
    settled,
)

N_FREE, CHANNELS, LINES, POSTURES = 40, 9, 5, 4


def made(rng, errors=None):
    """A linear model of four postures; what its fit leaves of errors, drawn if not given."""
    shape = (POSTURES, N_FREE, CHANNELS, 2 * LINES)
    J = rng.standard_normal(shape) * np.geomspace(3.0, 0.05, N_FREE)[:, None, None]
    e = rng.standard_normal((POSTURES, CHANNELS, 2 * LINES)) if errors is None else errors
    flat = J.transpose(1, 0, 2, 3).reshape(N_FREE, -1)
    u = np.linalg.solve(flat @ flat.T + np.eye(N_FREE), flat @ e.reshape(-1))
    left = e - np.tensordot(u, J.transpose(1, 0, 2, 3), axes=1)
    parts = [Sensitivities(raw=j, clean=j, left=r) for j, r in zip(J, left, strict=True)]
    return parts, e


@pytest.mark.long
def test_what_a_fit_took_of_the_errors_is_given_back_on_average():
    rng = np.random.default_rng(1)
    ratios, fitted = [], []
    for _ in range(200):
        parts, e = made(rng)
        back = released(parts, np.arange(N_FREE))
        ratios.append(np.sum(np.square(back)) / np.sum(e**2))
        fitted.append(sum(np.sum(p.left**2) for p in parts) / np.sum(e**2))
    # Of 360 residuals the fit takes what its prior leaves of 40 parameters.
    assert np.mean(fitted) < 0.93
    # Mean of 200; unbiased where errors are independent and parameters as their priors: here none
    # is off, and the prior keeps a little less than that.
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.03)


def test_the_rest_of_a_fit_s_way_is_no_error_of_what_tells_a_direction_alone():
    """Three postures tell a parameter a thousandth as well as the fourth, and the fit has a step
    to go there that brings eight nats, few beside what is left.
    """
    rng = np.random.default_rng(4)
    free = np.arange(N_FREE)
    J = rng.standard_normal((POSTURES, N_FREE, CHANNELS, 2 * LINES))
    J[1:, 0] *= 1e-3
    J[0, 0] *= 100.0
    e = 10.0 * rng.standard_normal((POSTURES, CHANNELS, 2 * LINES))
    flat = J.transpose(1, 0, 2, 3).reshape(N_FREE, -1)
    ended = np.linalg.solve(flat @ flat.T + np.eye(N_FREE), flat @ e.reshape(-1))

    def parts_at(u):
        left = e - np.tensordot(u, J.transpose(1, 0, 2, 3), axes=1)
        return [Sensitivities(raw=j, clean=j, left=r) for j, r in zip(J, left, strict=True)]

    short = ended.copy()
    short[0] += 4.0 / np.linalg.norm(J[0, 0])
    size = np.linalg.norm(released(parts_at(ended), free))
    assert np.linalg.norm(released(parts_at(short), free)) > 10.0 * size
    for u in (ended, short):
        there = settled(parts_at(u), free, flat @ flat.T, u)
        np.testing.assert_allclose(
            [p.left for p in there], [p.left for p in parts_at(ended)], atol=1e-9
        )


def test_all_modes_with_amplitude_one_are_the_error_itself():
    rng = np.random.default_rng(2)
    parts, e = made(rng)
    for part, error, slopes in zip(parts, e, error_slopes(parts, list(e)), strict=True):
        want = np.tensordot(part.clean, error, axes=2)
        np.testing.assert_allclose(slopes.real.sum(axis=1), want, rtol=1e-9, atol=1e-9)


def soft_and_hard(rng, own_part):
    """Slopes' variance of the same derivatives under soft and hard hits, and with those turned."""
    J = rng.standard_normal((2, CHANNELS, 2 * LINES))
    shared, *own = rng.standard_normal((3, CHANNELS, 2 * LINES))
    part = Sensitivities(
        raw=np.concatenate([J, J], axis=1),
        clean=np.concatenate([J, J], axis=1),
        left=np.concatenate([(1.0 - own_part) * shared + own_part * e for e in own]),
        side=np.repeat([1.0, -1.0], CHANNELS),
    )
    parts = [part], opposed([part])
    slopes = [error_slopes(these, [p.left for p in these])[0] for these in parts]
    return [np.sum(np.abs(own) ** 2) for own in slopes]


def test_what_soft_and_hard_hits_share_cancels_once_hard_ones_are_turned_round():
    as_it_is, turned = soft_and_hard(np.random.default_rng(5), own_part=0.0)
    assert turned < 1e-20 * as_it_is
    rng = np.random.default_rng(6)
    each = np.array([soft_and_hard(rng, own_part=1.0) for _ in range(400)])
    # Errors of single hits are as large turned round; means of 400 are known to some percent.
    assert each[:, 1].mean() == pytest.approx(each[:, 0].mean(), rel=0.1)


def test_there_is_nothing_to_turn_round_where_all_hits_are_together():
    parts, _ = made(np.random.default_rng(7))
    assert opposed(parts) == []


def test_errors_of_one_pattern_scatter_a_slope_as_much_as_their_power():
    """One mode: its amplitude is a complex Gaussian, so a slope's variance is half its power."""
    rng = np.random.default_rng(3)
    z = np.outer(rng.standard_normal(CHANNELS), rng.standard_normal(LINES)).astype(complex)
    J = rng.standard_normal((2, CHANNELS, 2 * LINES))
    part = Sensitivities(raw=J, clean=J, left=z.view(float))
    (slopes,) = error_slopes([part], [z.view(float)])
    power = np.sum(np.abs(slopes) ** 2, axis=1)
    draws = rng.standard_normal((2, slopes.shape[1], 20_000)) / np.sqrt(2.0)
    drawn = slopes.real @ draws[0] - slopes.imag @ draws[1]
    # A variance of 20 000 draws has a deviation of sqrt(2 / 20 000) = 1 %: four of them.
    np.testing.assert_allclose(drawn.var(axis=1), power / 2.0, rtol=0.04)


def test_curvature_is_the_sum_over_postures():
    parts, _ = made(np.random.default_rng(4))
    want = sum(p.raw.reshape(N_FREE, -1) @ p.clean.reshape(N_FREE, -1).T for p in parts)
    np.testing.assert_allclose(curvature_of(parts), want)


def test_derivatives_in_single_precision_that_hardly_differ_are_no_obstacle():
    """Their curvature, by rounding, has eigenvalues far below zero."""
    rng = np.random.default_rng(4)
    one = 1e5 * rng.standard_normal((1, CHANNELS, 2 * LINES))
    J = (one + rng.standard_normal((N_FREE, CHANNELS, 2 * LINES))).astype(np.float32)
    flat = J.reshape(N_FREE, -1)
    assert np.linalg.eigvalsh((flat @ flat.T).astype(float))[0] < -1.0
    part = Sensitivities(raw=J, clean=J, left=rng.standard_normal((CHANNELS, 2 * LINES)))
    (back,) = released([part], np.arange(N_FREE))
    assert np.isfinite(back).all()
