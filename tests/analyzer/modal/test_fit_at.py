from functools import cache

import numpy as np
import pytest
from support.simulated_frfs import eight_modes

from armodal.analyzer.modal import fit_modes, fit_modes_at
from armodal.protocols.errors import EstimateError


@cache
def fitted():
    frf = eight_modes(np.random.default_rng(5), n_resp=10).frf
    return frf, fit_modes(frf)


def _picked_from(frf, table, picked_hz):
    stable = table.pole_rad_s.real < 0.0
    at = [np.argmin(np.abs(table.f_hz - f) + 1e9 * ~stable) for f in picked_hz]
    return fit_modes_at(frf, table.pole_rad_s[at], table)


def test_poles_picked_by_hand_are_refined_and_none_is_added_or_dropped():
    frf, automatic = fitted()
    chosen = automatic.f_hz[[0, 2, 3]]
    model = _picked_from(frf, automatic.stabilisation, chosen)
    assert len(model.modes) == 3
    everything = _picked_from(frf, automatic.stabilisation, automatic.f_hz)
    # The same least-squares problem from another start: its tolerance is 1e-5 of a half bandwidth.
    assert everything.f_hz == pytest.approx(automatic.f_hz, rel=1e-5)


@pytest.mark.parametrize("pole", [1.0 + 300j, -1.0 + 1e7j, np.nan + 1j])
def test_an_unstable_pole_or_one_outside_the_band_is_refused(pole):
    frf, automatic = fitted()
    with pytest.raises(EstimateError, match="wanted stable poles"):
        fit_modes_at(frf, [pole], automatic.stabilisation)
