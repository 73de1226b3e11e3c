"""What every posture gains recurs; what one posture alone gains may be its error."""

import numpy as np
import pytest
from scipy import stats

from armodal.analyzer.gap.decision.recurrence import recurrence
from armodal.analyzer.gap.effects import hit_direction
from armodal.analyzer.gap.model.effect import Instance

EFFECT = Instance(effect=hit_direction.WORDS, place="p")
OF_ONE = Instance(effect=hit_direction.WORDS, place="p", of_one_posture=True)


def of(*gains):
    return dict(zip("abcde", gains, strict=False))


def test_it_is_one_less_the_p_of_student_s_test_over_postures():
    gains = [7.0, 11.0, 6.0]
    wanted = 1.0 - stats.ttest_1samp(gains, 0.0, alternative="greater").pvalue
    np.testing.assert_allclose(recurrence(EFFECT, of(*gains)), wanted, rtol=1e-9)


def test_a_gain_of_one_posture_alone_is_hardly_told():
    assert recurrence(EFFECT, of(20.5, 20.0, 20.2)) > 0.999
    assert recurrence(EFFECT, of(60.0, 0.0, 0.7)) < 0.9


def test_what_acts_in_one_posture_is_not_judged_by_others():
    assert recurrence(OF_ONE, of(60.0, 0.0, 0.0)) == 1.0


@pytest.mark.parametrize(("gain", "wanted"), [(2.0, 1.0), (-2.0, 0.0)])
def test_gains_all_alike_leave_no_doubt(gain, wanted):
    assert recurrence(EFFECT, of(gain, gain, gain)) == wanted
