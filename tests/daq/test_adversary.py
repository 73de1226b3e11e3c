"""A session disturbed in every way there is: no hit that was announced is lost."""

from __future__ import annotations

import re
from datetime import datetime, timedelta
from functools import partial
from itertools import count
from pathlib import Path

import pytest
from support.adversary import KINDS, disturbed_session
from support.fault_runs import run_seed
from support.virtual_lab import VirtualLab

import armodal.daq
from armodal.protocols.session.compare import first_difference
from armodal.protocols.session.journal import decode_journal

QUICK = {
    "removed",
    "replaced_by_a_link",
    "cut",
    "folder_moved",
    "lock_removed",
    "permission withdrawn",
    "full",
    "late errors, told at every sync",
    "host stops for 30 s",
    "board-reboot",
    "clock-jump",
    "missing calibration",
}
COARSE_S = 0.01  # a step of the laboratory: half the time of its finer ones


def seeds():
    """Each kind of disturbance once; in the quick tests those whose answers differ."""
    for seed, kind in enumerate(KINDS):
        yield pytest.param(seed, id=kind, marks=() if kind in QUICK else pytest.mark.long)


@pytest.mark.parametrize("seed", [*seeds()])
def test_no_announced_hit_is_lost(seed):
    found = disturbed_session(seed, step_s=COARSE_S)
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


@pytest.mark.long
def test_a_session_is_the_same_whatever_the_clock_on_the_wall_does(monkeypatch):
    """Set back and forth at every look at it, or stopped as in a leap second."""
    coarse = partial(VirtualLab, step_s=COARSE_S)
    quiet = run_seed(0, script=((), ()), make_lab=coarse)
    for steps_s in ((0.0,), (-86400.0, 86400.0 * 3650.0), (-1.0, 0.0)):
        looks = count()

        class Jumping(datetime):
            @classmethod
            def now(cls, tz=None):
                by_s = steps_s[next(looks) % len(steps_s)]  # noqa: B023 - of this turn
                return datetime(2026, 12, 31, 23, 59, 59, tzinfo=tz) + timedelta(seconds=by_s)

        monkeypatch.setattr("armodal.daq.acquisition.datetime", Jumping)
        monkeypatch.setattr("armodal.daq.holder.datetime", Jumping)
        jumped = run_seed(0, script=((), ()), make_lab=coarse)
        assert next(looks) > 0  # it was looked at
        assert jumped.violations == quiet.violations == []
        ours, theirs = (decode_journal(one.journal) for one in (quiet, jumped))
        assert first_difference(ours.hits, theirs.hits, "hits") is None
        assert (ours.marks, ours.losses) == (theirs.marks, theirs.losses)
