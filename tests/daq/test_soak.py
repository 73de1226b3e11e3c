"""Three seconds of `bench/torture_soak.py`."""

import pytest
from torture_soak import soak


@pytest.mark.long
def test_samples_in_are_samples_accounted_for(tmp_path):
    told = soak(3.0, tmp_path)
    assert told["failed"] == ""
    assert told["unexplained"] == 0
    assert told["samples in"] > 0
    assert told["hits"] == told["hits announced"]
