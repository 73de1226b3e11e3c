"""A board that reboots at any request to it, or at any prompt, costs no announced hit."""

from __future__ import annotations

import pytest
from support.fault_runs import run_seed
from support.rebooting_lab import RebootingLab

from armodal.daq.events import Finished
from armodal.daq.session_machine import PromptKind
from armodal.protocols.board.records import FrameType


def run(at_moment, *, seed=0):
    """Return what became of a session without other faults, and its laboratory."""
    labs = []

    def made(*args, **named):
        labs.append(RebootingLab(*args, at_moment=at_moment, step_s=0.01, **named))
        return labs[-1]

    return run_seed(seed, script=((), ()), make_lab=made), labs[-1]


@pytest.fixture(scope="module")
def moments():
    """Requests and prompts of a session that nothing disturbs."""
    _, lab = run(None)
    return tuple(lab.moments)


def test_a_session_has_a_moment_of_every_kind(moments):
    told_when_something_is_missing = {FrameType.RESEND}
    requests = {kind for kind in FrameType if not kind & 0x80} - told_when_something_is_missing
    assert set(moments) == requests | set(PromptKind)


@pytest.mark.parametrize("every", [False, pytest.param(True, marks=pytest.mark.long)])
def test_a_reboot_at_any_of_them_is_told_and_loses_no_announced_hit(moments, every):
    """At every moment, or at the first of each kind."""
    for number, moment in enumerate(moments):
        if not every and moment in moments[:number]:
            continue
        found, lab = run(number)
        assert found.violations == [], (number, moment)
        assert lab.moments[number] == moment
        assert isinstance(found.endings[-1], Finished), (number, moment)
        assert found.counts["accepted"] == 4, (number, moment)  # two points, two hits each
