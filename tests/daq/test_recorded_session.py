"""The session that the tortures of `bench/` stop everywhere holds what they need."""

from pathlib import Path

import numpy as np
import pytest
from recorded_session import HITS, POINTS, recorded
from support.accepted_hits import quick_folder, wrong_after_stop
from support.recorded_disk import kill_points

PLANNED = HITS * len(POINTS)


@pytest.mark.long
def test_it_announces_every_planned_hit_and_can_be_stopped_anywhere(tmp_path):
    log = recorded(1, tmp_path).log
    announced = {hit.number for change in log for hit in change.hits}
    assert len(announced) >= PLANNED
    assert {"create", "write", "sync", "cut", "replace", "folder"} <= {
        change.kind for change in log
    }
    rng = np.random.default_rng(1)
    n_kills = 0
    with quick_folder() as folder:
        for where, files, hits in kill_points(log, rng, places=75):
            if n_kills % 300 == 0:
                wrong = wrong_after_stop(files, hits, Path(folder), "session.journal")
                assert wrong is None, where
            n_kills += 1
    assert n_kills >= 2000
