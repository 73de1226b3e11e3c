from dataclasses import replace

import numpy as np
import pytest
from support import closed_form
from support.closed_form import frequency_response

from armodal.analyzer.checks import Fault, Outcome, reciprocity


def both():
    return frequency_response(["a"], ["b"]), frequency_response(["b"], ["a"])


def test_exchanged_paths_of_a_linear_structure_are_reciprocal():
    (finding,) = reciprocity(both())
    assert finding.outcome is Outcome.GOOD
    assert set(finding.points) == {"a", "b"}


def test_one_set_with_two_references_is_enough():
    (finding,) = reciprocity([frequency_response(["a", "b"], ["a", "b"])])
    assert finding.outcome is Outcome.GOOD


@pytest.mark.parametrize(
    ("factor", "fault"), [(-1.0, Fault.SIGN_FLIPPED), (1.15, Fault.GAIN), (0.85, Fault.GAIN)]
)
def test_a_factor_on_one_side_is_named(factor, fault):
    first, second = both()
    (finding,) = reciprocity([first, replace(second, values=factor * second.values)])
    assert (finding.outcome, finding.fault) == (Outcome.FAULT, fault)


def test_swapped_axes_break_reciprocity():
    first, second = both()
    (finding,) = reciprocity([first, replace(second, values=second.values[[1, 0, 2]])])
    assert (finding.outcome, finding.fault) == (Outcome.FAULT, Fault.NOT_RECIPROCAL)


def test_noise_of_a_good_measurement_names_nothing():
    # 2 % of the rms of each FRF: the ratio of two FRFs over 225 lines is known to 0.2 %.
    for seed in range(20):
        rng = np.random.default_rng(seed)
        first = frequency_response(["a"], ["b"], noise=0.02, rng=rng)
        second = frequency_response(["b"], ["a"], noise=0.02, rng=rng)
        (finding,) = reciprocity([first, second])
        assert finding.outcome is Outcome.GOOD, finding.text


def test_a_hole_whose_mirror_was_measured_is_told_and_compared_with_nothing():
    frf = frequency_response(["a", "b"], ["a", "b"])
    rows = [i for i, dof in enumerate(frf.responses) if dof.point == "a"]
    column = [dof.point for dof in frf.references].index("b")
    values, variance = frf.values.copy(), frf.variance.copy()
    values[rows, column], variance[rows, column] = 0.0, np.inf
    nothing, told = reciprocity([replace(frf, values=values, variance=variance)])
    assert "hit one more point" in nothing.text
    assert (told.outcome, set(told.points)) == (Outcome.CANNOT_TELL, {"a", "b"})
    assert "a under a hit at b was not measured; b under a hit at a was" in told.text


def test_one_hit_point_cannot_tell():
    (finding,) = reciprocity([frequency_response(["a", "b"], ["a"])])
    assert finding.outcome is Outcome.CANNOT_TELL


def hit_two_ways(monkeypatch):
    """Points a and b, both measured and hit; then a hit along another direction."""
    first = frequency_response(["a", "b"], ["a", "b"])
    monkeypatch.setitem(closed_form.HITS, "a", np.array([0.0, -0.6, 0.8]))
    return first, frequency_response(["a", "b"], ["a"])


def test_a_point_hit_along_two_directions_is_reciprocal_along_both(monkeypatch):
    frfs = hit_two_ways(monkeypatch)
    findings = reciprocity(frfs)
    assert [finding.outcome for finding in findings] == [Outcome.GOOD] * 2
    assert "a along (0.60, 0.64, 0.48) and b" in findings[0].text
    # Wherever the second direction stands, in a file of its own or beside the first.
    assert [f.outcome for f in reciprocity(frfs[::-1])] == [Outcome.GOOD] * 2


def test_of_two_directions_the_one_at_fault_is_told(monkeypatch):
    first, second = hit_two_ways(monkeypatch)
    findings = reciprocity([first, replace(second, values=-second.values)])
    assert [finding.fault for finding in findings] == [None, Fault.SIGN_FLIPPED]
    assert "a along (0.00, -0.60, 0.80)" in findings[1].text
