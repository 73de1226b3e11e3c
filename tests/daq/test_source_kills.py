"""Sessions on each source of samples, killed at drawn times: what was told of is in the journal.

`bench/torture_source_kills.py` does the same at length; its figures are in `docs/front-ends.md`.
"""

import numpy as np
import pytest
from support.source_kills import KilledSession

NEEDS = {"ni": ("nidaqmx", "grpc"), "opendaq": ("opendaq",)}


@pytest.mark.parametrize(
    ("name", "kills"),
    [
        ("replay", 2),
        pytest.param("ni", 3, marks=pytest.mark.long),
        pytest.param("sound", 3, marks=pytest.mark.long),
        pytest.param("opendaq", 3, marks=pytest.mark.long),
    ],
)
def test_a_session_killed_at_any_time_keeps_its_hits_and_goes_on(name, kills, tmp_path):
    for package in NEEDS.get(name, ()):
        pytest.importorskip(package)
    session = KilledSession(name, tmp_path, np.random.default_rng(2))
    try:
        for _ in range(kills):
            session.kill_once()
    finally:
        session.close()
    assert session.tally.wrong == []
    assert session.tally.kills == kills
    assert session.tally.accepted > 0
