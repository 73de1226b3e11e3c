from __future__ import annotations

from armodal.daq.losses import LossTally


def test_losses_of_one_kind_become_one_record_with_their_sum():
    losses = LossTally()
    losses.add("stream", 10, "gap", 1.0, first_sample=100)
    losses.add("stream", 5, "gap", 2.0, first_sample=300)
    losses.add("can", 1, "skipped", 3.0)
    stream, can = losses.take()
    assert (stream.count, stream.first_sample, stream.host_s) == (15, 100, 1.0)
    assert (can.kind, can.count) == ("can", 1)
    assert losses.take() == ()


def test_a_growing_counter_is_noted_by_what_it_grew():
    losses = LossTally()
    for total in (0, 3, 3, 7):
        losses.watch("frame", total, "bad", 1.0)
    assert [loss.count for loss in losses.take()] == [7]
    losses.watch("frame", 8, "bad", 2.0)
    assert [loss.count for loss in losses.take()] == [1]
