"""Three seconds of `bench/torture_soak.py`, and four minutes of a day of samples."""

import pytest
from support.day_session import RATE_HZ, run_day
from torture_soak import soak


@pytest.mark.long
def test_samples_in_are_samples_accounted_for(tmp_path):
    told = soak(3.0, tmp_path)
    assert told["failed"] == ""
    assert told["unexplained"] == 0
    assert told["samples in"] > 0
    assert told["hits"] == told["hits announced"]


def test_a_day_is_sampled_in_flat_memory(tmp_path):
    """Four minutes of `bench/torture_day_soak.py`."""
    day = run_day(tmp_path, 250.0)
    assert day.failed == ""
    assert day.taken >= 250 * RATE_HZ
    assert day.unexplained == 0
    assert day.kept == day.announced == 2
    assert day.lost == day.altered == []
    # All that is made once is made in the first tenth; from there on a page now and then.
    assert day.grown <= 2**20 + day.journal_bytes
