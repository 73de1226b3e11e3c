"""Groups refined at once end where each ends alone."""

import numpy as np
import pytest
from support.simulated_frfs import modal_frf, poles_of

from armodal.analyzer.modal.refine import refine_poles
from armodal.analyzer.modal.refine_each import refine_each
from armodal.analyzer.modal.regression import modal_data
from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.frf_records import FrfForm

FREQ = 0.25 * np.arange(120, 260)
FORM = FrfForm.ACCELERANCE


def measured(rng, group, poles_of_group):
    """FRFs of groups with poles of their own, their lines' variance, and the data of all."""
    values, variance = [], []
    for g in group:
        residues = rng.standard_normal((2, 1, 1)) + 0.1j * rng.standard_normal((2, 1, 1))
        clean = modal_frf(poles_of_group[g], residues, FREQ, FORM)[0, 0]
        level = 1e-3 * np.mean(np.abs(clean) ** 2) * rng.uniform(0.5, 2.0, FREQ.size)
        noise = rng.standard_normal((2, FREQ.size)).T @ np.array([1.0, 1j])
        values.append(clean + np.sqrt(level / 2.0) * noise)
        variance.append(level)
    return np.array(values), np.array(variance)


def data_of(values, variance):
    return modal_data(FORM, laplace_lines(FREQ, 0.0), values, variance)


@pytest.mark.parametrize("seed", range(4))
def test_groups_of_unequal_size_end_where_each_ends_alone(seed):
    rng = np.random.default_rng(seed)
    group = np.array([0, 0, 0, 1, 2, 2, -1])
    own = [poles_of([40.0 + move, 52.0 - move], [0.01, 0.02]) for move in (0.0, 0.4, -0.3)]
    values, variance = measured(rng, np.maximum(group, 0), own)
    variance[1] = np.inf  # not measured
    starts = np.stack([np.stack(own) * (1.0 + 0.002 * k) for k in (-1.0, 2.0)])
    poles, cost = refine_each(data_of(values, variance), group, starts)
    for k, start in enumerate(starts):
        for g in range(3):
            alone = refine_poles(data_of(values[group == g], variance[group == g]), start[g])
            # A step ends below 1e-5 half bandwidths: both stop within a few of those.
            assert np.max(np.abs(poles[k, g] - alone.poles) / -alone.poles.real) < 1e-4
            assert cost[k, g] == pytest.approx(float(alone.cost.sum()), rel=1e-6)


def test_a_step_beyond_what_a_structure_can_have_is_not_taken():
    rng = np.random.default_rng(9)
    own = [poles_of([40.0, 52.0], [0.01, 0.02])]
    values, variance = measured(rng, np.array([0]), own)
    far = poles_of([[[31.0, 60.0]]], [[[0.55, 0.55]]])  # a full step from here overdamps a pole
    poles, cost = refine_each(data_of(values, variance), np.array([0]), far)
    before = refine_poles(data_of(values, variance), far[0, 0], enough=lambda _a, _b: True)
    assert np.all(-poles.real < 0.6 * np.abs(poles))
    assert cost[0, 0] <= float(before.cost.sum())
