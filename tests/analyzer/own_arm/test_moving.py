"""Places by three distances, against the places they were measured at."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.analyzer.own_arm.moving import by_distances
from armodal.protocols.errors import ArmError

KNOWN = [np.array(place) for place in ([0.1, 0.0, 0.0], [0.0, 0.3, 0.1], [-0.2, 0.1, 0.2])]
coordinate = st.floats(-0.5, 0.5)


@given(st.tuples(coordinate, coordinate, coordinate))
def test_one_of_the_two_places_is_the_measured_one(place):
    target = np.array(place)
    distances = [float(np.linalg.norm(target - one)) for one in KNOWN]
    found = by_distances(KNOWN, distances, "point")
    # Near the plane of the three the height is the root of a small difference of squares.
    assert np.linalg.norm(found - target, axis=1).min() < 1e-6


def test_distances_that_no_place_has_and_three_points_on_a_line_are_refused():
    with pytest.raises(ArmError, match="no place has the distances 10, 10, 10 mm"):
        by_distances(KNOWN, [0.01, 0.01, 0.01], "point 7")
    line = [np.array([x, 0.0, 0.0]) for x in (0.0, 0.1, 0.2)]
    with pytest.raises(ArmError, match="not on one line"):
        by_distances(line, [0.1, 0.1, 0.1], "point 7")
