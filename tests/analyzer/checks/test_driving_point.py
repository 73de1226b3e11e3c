from dataclasses import replace

import numpy as np
import pytest
from support.closed_form import frequency_response

from armodal.analyzer.checks import Fault, Outcome, driving_point
from armodal.protocols.frf_records import FrfForm


@pytest.mark.parametrize("form", list(FrfForm))
def test_a_driving_point_takes_energy_in_every_form(form):
    finding = driving_point(frequency_response(["a", "b"], ["a"], form=form))
    assert finding.outcome is Outcome.GOOD
    # Three modes: two pairs of neighbours, an anti-resonance in each.
    assert "between 2 of 2" in finding.text


def test_a_flipped_sign_gives_energy_everywhere():
    frf = frequency_response(["a"], ["a"])
    finding = driving_point(replace(frf, values=-frf.values))
    assert (finding.outcome, finding.fault) == (Outcome.FAULT, Fault.SIGN_FLIPPED)
    assert finding.points == ("a",)


def test_one_flipped_axis_gives_energy_at_some_resonances():
    frf = frequency_response(["a"], ["a"])
    values = frf.values * np.array([1.0, 1.0, -1.0])[:, None, None]
    # Along the hit the third mode then reads -0.3 - 0.384 + 0.256 < 0 where it is hit with 0.34.
    finding = driving_point(replace(frf, values=values))
    assert (finding.outcome, finding.fault) == (Outcome.FAULT, Fault.NOT_A_DRIVING_POINT)
    assert "70" in finding.text


def test_without_the_point_that_is_hit_it_cannot_tell():
    assert driving_point(frequency_response(["b"], ["a"])).outcome is Outcome.CANNOT_TELL


def test_nothing_but_noise_cannot_tell():
    rng = np.random.default_rng(3)
    frf = frequency_response(["a"], ["a"])
    noise = rng.standard_normal((2, *frf.values.shape))
    level = np.full(frf.values.shape, 2.0)
    frf = replace(frf, values=noise[0] + 1j * noise[1], variance=level)
    assert driving_point(frf).outcome is Outcome.CANNOT_TELL
