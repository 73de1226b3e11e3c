"""Width of a pulse at half its peak."""

import numpy as np
import pytest

from armodal.hil_sim.pulse_width import half_width


@pytest.mark.parametrize(("length", "begin"), [(30.0, 5.0), (12.0, 7.3), (8.0, 3.9)])
def test_a_half_sine_is_two_thirds_of_its_length_wide(length, begin):
    phase = (np.arange(60.0) - begin) / length
    force = np.where((phase > 0.0) & (phase < 1.0), np.sin(np.pi * phase), 0.0)
    # A sampled peak is up to (pi / 2 length)^2 / 2 low; a line lies below a curve by as little.
    assert half_width(force) == pytest.approx(length / 1.5, rel=2.0 * (np.pi / 2.0 / length) ** 2)


def test_a_second_pulse_is_none_of_it():
    assert half_width(np.array([0.0, 4.0, 8.0, 2.0, 0.0, 6.0, 0.0])) == pytest.approx(1.0 + 4 / 6)


def test_what_is_not_recorded_ends_with_the_record():
    assert half_width(np.array([3.0, 4.0, 0.0])) == pytest.approx(1.0 + 0.5)
