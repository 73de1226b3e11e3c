"""Which poles may be copies of one mode."""

import numpy as np
from support.simulated_frfs import poles_of

from armodal.analyzer.modal.about_modes import linked_runs


def test_copies_of_a_mode_that_moves_are_one_run():
    poles = poles_of(np.array([300.0, 100.0, 101.5, 103.0]), np.array([0.01, 0.01, 0.02, 0.01]))
    assert linked_runs(poles, 6.0) == [[1, 2, 3], [0]]


def test_a_wide_pole_does_not_link_the_modes_that_stand_in_it():
    f_hz, damping = np.array([100.0, 150.0, 200.0]), np.array([0.01, 0.2, 0.01])
    assert linked_runs(poles_of(f_hz, damping), 6.0) == [[0], [1], [2]]


def test_poles_linked_by_one_between_them_are_one_run_in_any_order():
    f_hz, damping = np.array([100.0, 109.0, 104.5]), np.full(3, 0.01)
    for order in ([0, 1, 2], [2, 1, 0], [1, 2, 0]):
        poles = poles_of(f_hz[order], damping)
        (run,) = linked_runs(poles, 6.0)
        assert np.array_equal(np.abs(poles[run]), np.sort(np.abs(poles)))
