"""A hammer that reads too much: all masses and stiffnesses follow, and what is stated says so."""

from dataclasses import replace

import numpy as np
import pytest
from support.small_case import small_case

from armodal.analyzer.gap.workflow import find_gap
from armodal.analyzer.identification.identify import identify

READS = 1.2  # times the force: twenty of the hammer's stated deviations
SURE = 3.0  # deviations: one of five joints is beyond them once in 70 sessions


@pytest.mark.long
def test_a_hammer_far_off_leaves_no_stiffness_outside_its_stated_deviation():
    case = small_case(4, "rv4frl")
    session = case.session()
    force = np.array([READS, *np.ones(session.hits[0].counts.shape[1] - 1)])
    hits = tuple(replace(hit, counts=np.int32(np.rint(hit.counts * force))) for hit in session.hits)
    result = find_gap(replace(session, hits=hits), gates=False, modes=False, advice=False).result
    right = find_gap(session, gates=False, modes=False, advice=False).result
    by_modes = {row.joint: row for row in identify(replace(session, hits=hits)).joints}
    for row, true in zip(result.joint_stiffness_ranges, right.joint_stiffness_ranges, strict=True):
        both = np.hypot(row.k_std, true.k_std)
        assert abs(row.k_n_m_per_rad - true.k_n_m_per_rad) < SURE * both
        found = by_modes[row.joint]
        both = np.hypot(row.k_std, np.hypot(found.k_std, found.k_std_model))
        assert abs(row.k_n_m_per_rad - found.k_n_m_per_rad) < SURE * both
