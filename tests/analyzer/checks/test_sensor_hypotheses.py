import numpy as np

from armodal.analyzer.checks.records import Fault
from armodal.analyzer.checks.sensor_hypotheses import (
    axis_text,
    hypotheses,
    permutation_fault,
    signed_permutations,
)


def test_there_are_48_signed_permutations_half_of_them_rotations():
    matrices = signed_permutations()
    assert len({m.tobytes() for m in matrices + 0.0}) == 48
    np.testing.assert_array_equal(matrices[0], np.eye(3))
    assert np.sum(np.linalg.det(matrices) > 0) == 24
    np.testing.assert_array_equal(matrices @ matrices.transpose(0, 2, 1), [np.eye(3)] * 48)


def test_seven_are_flips_and_forty_swaps():
    faults = [permutation_fault(m) for m in signed_permutations()[1:]]
    assert faults.count(Fault.SIGN_FLIPPED) == 7
    assert faults.count(Fault.AXIS_SWAPPED) == 40


def test_the_text_tells_what_was_recorded():
    turned = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    # true = correction @ recorded: true x is recorded y, true y is minus recorded x.
    assert axis_text(turned) == "x recorded -y, y recorded x"


def test_every_hypothesis_is_told_from_every_other():
    index = np.array([0, 2, 3])
    found = hypotheses(index, ("1", "2", "3", "4", "5"))
    keys = {(h.correction.tobytes(), h.rows.tobytes()) for h in found}
    # Nothing; 47 at each of three points; at all, those with a positive sum of entries (the other
    # half of the pairs of opposite sign); four other points each; three exchanges.
    everywhere = int(np.sum(signed_permutations()[1:].sum(axis=(1, 2)) > 0))
    assert everywhere == 23
    assert len(found) == 1 + 47 * 3 + everywhere + 3 * 4 + 3
    assert len(keys) == len(found)
