"""Sums over lines in closed form are those of the products multiplied out."""

import numpy as np
import pytest

from armodal.analyzer.modal.gram import gram, weighted_lines
from armodal.analyzer.modal.regression import residual_terms
from armodal.protocols.frf_records import FrfForm

FREQ_HZ = np.arange(5.0, 60.0, 0.25)


def multiplied_out(s, poles, weight, weighted, residual, *, pole_terms):
    """(n_weights, q, q) and (n_frf, q), row by row."""

    def pairs(power):
        d, m = (1.0 / (s - p[:, None]) ** power for p in (poles, poles.conj()))
        rows = np.empty((2 * poles.size, s.size), dtype=complex)
        rows[0::2], rows[1::2] = d + m, 1j * (d - m)
        return rows

    rows = np.concatenate([pairs(1), residual, *([pairs(2)] if pole_terms else [])])
    G = np.einsum("ik,ok,jk->oij", rows.conj(), weight, rows).real
    return G, (weighted @ rows.conj().T).real


def drawn(rng, n, narrowest):
    """Weights, FRFs and poles, two of them all but one, one `narrowest` lines from the lines."""
    weight = 10.0 ** rng.uniform(-2.0, 2.0, (3, FREQ_HZ.size))
    frf = rng.standard_normal((2, 3, FREQ_HZ.size))
    w = 2.0 * np.pi * rng.uniform(3.0, 65.0, n)
    poles = w * (1j - 10.0 ** rng.uniform(-3.0, -0.5, n))
    poles[1] = poles[0] * (1.0 + 1e-9)
    poles[2] = 2j * np.pi * FREQ_HZ[60] - narrowest * 2.0 * np.pi * 0.25
    return weight, weight * (frf[0] + 1j * frf[1]), poles


@pytest.mark.parametrize("form", FrfForm)
@pytest.mark.parametrize("decay", [0.0, 3.0])
@pytest.mark.parametrize("narrowest", [1.0, 0.06, 1e-4])
@pytest.mark.parametrize("pole_terms", [True, False])
def test_sums_in_closed_form_are_those_multiplied_out(form, decay, narrowest, pole_terms):
    rng = np.random.default_rng(1)
    s = decay + 2j * np.pi * FREQ_HZ
    weight, weighted, poles = drawn(rng, 5, narrowest)
    residual = residual_terms(form, s, poles[3:4] * 1.1).T
    lines = weighted_lines(s, weight, weighted, residual)
    G, b = gram(lines, poles, pole_terms=pole_terms)
    G0, b0 = multiplied_out(s, poles, weight, weighted, residual, pole_terms=pole_terms)
    # Each beside its own size: what is lost of sixteen digits is the third power of a pole's
    # distance to the next line over twice that to the lines, and the weights' ratio of 1e4.
    root = np.sqrt(np.einsum("oii->oi", G0))
    assert np.max(np.abs(G - G0) / (root[:, :, None] * root[:, None, :])) < 1e-8
    energy = np.sqrt(np.sum(np.abs(weighted) ** 2 / weight, axis=-1))
    assert np.max(np.abs(b - b0) / (root * energy[:, None])) < 1e-13


def test_problems_apart_are_each_as_alone():
    rng = np.random.default_rng(2)
    s = 2j * np.pi * FREQ_HZ
    residual = residual_terms(FrfForm.ACCELERANCE, s).T
    made = [drawn(rng, 4, width) for width in (1.0, 1e-4)]
    weight, weighted, poles = (np.stack(parts) for parts in zip(*made, strict=True))
    G, b = gram(weighted_lines(s, weight, weighted, residual), poles)
    for i in (0, 1):
        own = gram(weighted_lines(s, weight[i], weighted[i], residual), poles[i])
        root = np.sqrt(np.einsum("oii->oi", own[0]))
        assert np.max(np.abs(G[i] - own[0]) / (root[:, :, None] * root[:, None, :])) < 1e-8
        np.testing.assert_allclose(b[i], own[1], rtol=1e-9)


def test_no_poles_leave_the_residual_terms_alone():
    rng = np.random.default_rng(3)
    s = 2j * np.pi * FREQ_HZ
    weight, weighted, _ = drawn(rng, 4, 1.0)
    residual = residual_terms(FrfForm.MOBILITY, s).T
    G, b = gram(weighted_lines(s, weight, weighted, residual), np.empty(0, dtype=complex))
    np.testing.assert_allclose(
        G, np.einsum("ik,ok,jk->oij", residual.conj(), weight, residual).real
    )
    np.testing.assert_allclose(b, (weighted @ residual.conj().T).real)
