"""A session disturbed in every way there is: no hit that was announced is lost."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from support.adversary import KINDS, disturbed_session

import armodal.daq

SMALL = len(KINDS)


@pytest.mark.parametrize("seed", range(SMALL), ids=KINDS)
def test_no_announced_hit_is_lost(seed):
    found = disturbed_session(seed)
    assert (found.lost, found.wrong) == ([], "")


def test_no_clock_of_the_wall_decides_anything():
    """What jumps when somebody sets the clock is written into headers, locks and notes only."""
    said = [
        f"{path.name}: {line.strip()}"
        for path in sorted(Path(armodal.daq.__path__[0]).glob("**/*.py"))
        for line in path.read_text(encoding="utf-8").splitlines()
        if re.search(r"time\.time\(|datetime\.now|CLOCK_REALTIME|localtime|\.today\(", line)
    ]
    assert said == [
        # The day on which a sensor was last used, in the memory of sensors.
        "acquisition.py: today = datetime.now(UTC).date().isoformat()",
        'acquisition.py: created=datetime.now(UTC).isoformat(timespec="seconds"),',
        'holder.py: since=datetime.now(UTC).isoformat(timespec="seconds"),',
    ]
