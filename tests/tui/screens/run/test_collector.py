"""When the app's garbage is collected; the clock is a number."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator
from unittest.mock import Mock

import pytest

from armodal.tui.screens.run.collector import AFTER_VERDICT_S, EVERY_S, CalmCollector


class Cycle:
    """What only the collector can take away."""

    def __init__(self) -> None:
        self.itself = self


@pytest.fixture(autouse=True)
def _as_in_a_program(freezing: None) -> Iterator[None]:
    """The tests have other thresholds, and leave out what they have loaded for good."""
    before = gc.get_threshold()
    gc.set_threshold(700, 10, 10)
    yield
    gc.set_threshold(*before)


@pytest.fixture
def collector(monkeypatch: pytest.MonkeyPatch) -> Iterator[CalmCollector]:
    """What the tests have loaded stays left out: to look at it takes long."""
    gc.freeze()
    monkeypatch.setattr(gc, "unfreeze", lambda: None)
    calm = CalmCollector()
    calm.begin(100.0)
    yield calm
    calm.end()


def old_garbage() -> weakref.ref[Cycle]:
    """Garbage of the oldest generation."""
    kept = Cycle()
    gc.collect(1)
    gc.collect(1)
    return weakref.ref(kept)


def test_garbage_goes_every_few_seconds(collector):
    seen = old_garbage()
    assert not collector.turn(100.0 + 0.9 * EVERY_S)
    assert seen() is not None
    assert collector.turn(100.0 + EVERY_S)
    assert seen() is None
    assert not collector.turn(100.1 + EVERY_S)


def test_a_verdict_is_on_the_screen_before_garbage_goes(collector):
    due_s = 100.0 + EVERY_S
    collector.verdict_came(due_s)
    assert not collector.turn(due_s)
    assert collector.turn(due_s + AFTER_VERDICT_S)
    collector.verdict_came(due_s + 2.0 * AFTER_VERDICT_S)
    assert not collector.turn(due_s + 3.0 * AFTER_VERDICT_S)  # it has just been done


def test_a_verdict_brings_forward_what_would_soon_come_before_another(collector):
    half_s = 100.0 + 0.6 * EVERY_S
    collector.verdict_came(half_s)
    assert collector.turn(half_s + AFTER_VERDICT_S)


def test_python_does_not_look_at_the_oldest_generation_by_itself(collector):
    before = gc.get_stats()[2]["collections"]
    kept = [[i] for i in range(20 * gc.get_threshold()[0] * gc.get_threshold()[1])]
    assert gc.get_stats()[2]["collections"] == before
    assert kept


def test_what_was_there_at_the_beginning_is_left_out_until_the_end(monkeypatch):
    gc.unfreeze()
    # All that the tests have loaded is a second's look each; what is frozen does not depend on it.
    monkeypatch.setattr(gc, "collect", Mock())
    threshold = gc.get_threshold()
    calm = CalmCollector()
    calm.begin(0.0)
    assert gc.get_freeze_count() > 0
    calm.begin(1.0)
    calm.end()
    assert (gc.get_threshold(), gc.get_freeze_count()) == (threshold, 0)


def test_in_a_pause_all_that_has_come_since_is_left_out_too(collector):
    seen, kept = old_garbage(), [[i] for i in range(1000)]
    frozen = gc.get_freeze_count()
    collector.pause_came(101.0)
    assert not collector.turn(101.0)
    assert collector.turn(101.0 + AFTER_VERDICT_S)
    assert seen() is None
    assert gc.get_freeze_count() >= frozen + len(kept)
    assert collector.turn(101.0 + AFTER_VERDICT_S + EVERY_S)
    assert gc.get_freeze_count() >= frozen + len(kept)


def test_one_that_has_not_begun_does_nothing():
    assert not CalmCollector().turn(1e9)
    CalmCollector().end()
