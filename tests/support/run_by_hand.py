"""The first hit of a session in a real terminal, with the simulated hand told by the test."""

from __future__ import annotations

from collections.abc import Callable

from support.terminal import Terminal

from armodal.daq.session_machine import begin, point_ready, posture_reached
from armodal.protocols.plan_records import Plan
from armodal.tui.operators import ScriptedOperator

MOST_HITS = 8  # the simulated hand does not always hit well


def first_accepted_hit(terminal: Terminal, hand: ScriptedOperator, plan: Plan) -> None:
    """Go from the laboratory to the first accepted hit, by keys."""
    at_posture = begin(plan)
    at_point = posture_reached(at_posture)
    for words in ("Are these sensors mounted", "Enter: begin"):
        terminal.until(words, 60.0)
        terminal.keys("Enter")
    terminal.until("Bring the arm to posture test 1", 60.0)
    hand.act(at_posture.prompt)
    terminal.until("Enter: yes, it is", 30.0)
    terminal.keys("Enter")
    terminal.until("Mount the sensor at point 1", 20.0)
    hand.act(at_point.prompt)
    terminal.keys("Enter")
    terminal.until("Hit point 1", 20.0)
    _hit_until_accepted(terminal, lambda: hand.act(point_ready(at_point).prompt))


def _hit_until_accepted(terminal: Terminal, hit: Callable[[], object]) -> None:
    for number in range(1, MOST_HITS + 1):
        hit()
        screen = terminal.until(rf"record {number}\b", 30.0)
        if "is in the journal" in screen:
            return
    raise AssertionError(f"{MOST_HITS} hits, and none was accepted")
