"""Where along its line a link gives way, in the equations of a posture."""

import numpy as np
import pytest
from support.bench_effects import instance_of, start_of

from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.long_links import SLICES, long_links

LINK = "lower_arm"
WAYS = 2  # directions across about which it has hinges at each place


@pytest.fixture
def system_of(ordinary, lines, posed):
    instance = instance_of(ordinary, "link_bending", LINK)
    hypothesis = Hypothesis(ordinary=ordinary, instances=(instance,))
    start = start_of(hypothesis) | {instance.size: 1e-5}

    def system(**shape):
        values = start | {f"bending {name} {LINK}": value for name, value in shape.items()}
        return posed.system(hypothesis, lines, values)

    return system


def test_a_link_may_give_way_in_its_middle_or_more_at_one_end(system_of):
    """The whole yield stays what it is."""

    def yields(**shape):
        return system_of(**shape).compliance[-WAYS * SLICES :: WAYS]

    even = yields()
    assert even == pytest.approx(np.full(SLICES, even.mean()))
    for shape in ({"middle": 9.0}, {"taper": -3.0, "middle": 1.0}, {"place": 0.2, "stretch": 0.1}):
        assert yields(**shape).sum() == pytest.approx(even.sum())
    # What stands beside the middle is 2 / SLICES of the way to an end from it.
    beside = 2.0 * np.exp(-9.0 * 2.0 / SLICES)
    assert yields(middle=9.0)[SLICES // 2] / even.sum() == pytest.approx(1.0, abs=1.2 * beside)
    root, *_, tip = yields(taper=3.0)  # half a slice from the ends
    assert np.log(tip / root) == pytest.approx(3.0 * (1.0 - 1.0 / SLICES))


def test_hinges_of_a_short_stretch_move_a_point_alike(system_of, ordinary):
    """A turn of one moves by no more than the stretch is long otherwise; of a long one by more."""
    line = next(x for x in long_links(ordinary.superset) if x.name == LINK)
    for stretch, alike in ((0.02, True), (1.0, False)):
        moved = system_of(place=0.4, stretch=stretch).moved[..., -WAYS * SLICES :: WAYS]
        apart = np.abs(moved - moved[..., :1]).max()
        assert bool(apart <= 0.02 * line.length_m) is alike
