"""What lowers the misfit of every posture recurs; what one posture alone gains may be its error."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats
from support.made_gap_fits import made_fit

from armodal.analyzer.gap.decision.recurrence import recurrence
from armodal.analyzer.gap.effects import hit_direction
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis

NAMES = ("a", "a", "b", "b", "c", "c")  # soft and hard hits of three postures
STAGE = SimpleNamespace(lines=[SimpleNamespace(name=name) for name in NAMES])


def fits(gains, *, of_one_posture=False):
    """Without and with an effect that takes so much off the misfit of each of the lines."""
    own = Instance(effect=hit_direction.WORDS, place="p", of_one_posture=of_one_posture)
    without = made_fit(Hypothesis(ordinary=None), cost=0.0, misfit=(100.0,) * len(NAMES))
    with_it = made_fit(
        Hypothesis(ordinary=None, instances=(own,)),
        cost=0.0,
        misfit=tuple(100.0 - np.array(gains)),
    )
    return without, with_it


def test_it_is_one_less_the_p_of_student_s_test_over_postures():
    gains = [3.0, 4.0, 9.0, 2.0, 1.0, 5.0]
    of_postures = [7.0, 11.0, 6.0]
    wanted = 1.0 - stats.ttest_1samp(of_postures, 0.0, alternative="greater").pvalue
    assert recurrence(STAGE, *fits(gains)) == pytest.approx(wanted)


def test_a_gain_of_one_posture_alone_is_hardly_told():
    even, uneven = [10.0, 10.5, 10.0, 10.0, 10.0, 10.2], [60.0, 0.0, 0.0, 0.0, 0.0, 0.7]
    assert recurrence(STAGE, *fits(even)) > 0.999
    assert recurrence(STAGE, *fits(uneven)) < 0.9


def test_what_acts_in_one_posture_is_not_judged_by_others():
    assert recurrence(STAGE, *fits([60.0, 0, 0, 0, 0, 0], of_one_posture=True)) == 1.0


@pytest.mark.parametrize(("gain", "wanted"), [(2.0, 1.0), (-2.0, 0.0)])
def test_gains_all_alike_leave_no_doubt(gain, wanted):
    assert recurrence(STAGE, *fits([gain] * len(NAMES))) == wanted
