from __future__ import annotations

from armodal.daq.commands import Stop
from armodal.daq.stopping import begin_stopping


def begin(command: Stop, earlier=None, now_s: float = 10.0):
    return begin_stopping(earlier, command, now_s, record_s=1.0, wall_s=1.0)


def test_a_plain_stop_waits_for_nothing():
    assert begin(Stop()).may_end(10.0, hit_under_way=True)


def test_a_hit_that_may_be_under_way_is_waited_for_but_not_for_ever():
    stopping = begin(Stop(finish_hit=True))
    assert stopping.may_end(10.0, hit_under_way=False)
    assert not stopping.may_end(11.9, hit_under_way=True)
    assert stopping.may_end(12.2, hit_under_way=True)  # two records and the lines' delay


def test_saying_it_again_does_not_wait_longer_and_a_plain_stop_ends_the_waiting():
    first = begin(Stop(finish_hit=True))
    assert begin(Stop(finish_hit=True), first, 11.0) is first
    assert begin(Stop(), first, 11.0).may_end(11.0, hit_under_way=True)
