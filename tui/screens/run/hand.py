"""The simulated operator, moved by a key: it does what is asked, in a thread of its own."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable

from armodal.daq.geometry import hit_direction
from armodal.protocols.arm.records import Arm, Point
from armodal.protocols.errors import ArmodalError
from armodal.protocols.plan_records import Mode, Plan
from armodal.tui.operators import Request, ScriptedOperator
from armodal.tui.screens.run.happenings import HandAtWork, HandIdle

__all__ = ["SimulatedHand", "mark_request", "trial_request"]


def trial_request(arm: Arm, plan: Plan, mass_kg: float | None) -> tuple[Request, str]:
    """Return a hit for trial: on a known mass, or where the first posture's hits will be."""
    if mass_kg is not None:
        return {"do": "hit-mass", "mass_kg": mass_kg}, "hits the known mass"
    posture = plan.postures[0]
    roving = plan.mode is Mode.ROVING_RESPONSE
    point = plan.fixed_point if roving else posture.points[0]
    direction = [float(x) for x in hit_direction(arm, posture, point)]
    return {"do": "hit", "point": point, "direction": direction}, "hits for trial"


def mark_request(point: Point) -> tuple[Request, str]:
    """Return what marks a point where the operator says it is."""
    R = point.R_link_sensor
    places = {"position_m": point.position_m, "normal": R[:, 2], "x_axis": R[:, 0]}
    told = {key: [float(x) for x in place] for key, place in places.items()}
    return {"do": "mark", "point": point.id, **told}, f"marks point {point.id} anew"


class SimulatedHand:
    """Does one thing after the other; says when it begins and when it is done.

    Parameters
    ----------
    operator
        The laboratory's operator.
    tell
        Called from the hand's own thread.
    """

    def __init__(
        self, operator: ScriptedOperator, tell: Callable[[HandAtWork | HandIdle], None]
    ) -> None:
        self._operator = operator
        self._tell = tell
        self._wanted: queue.SimpleQueue[tuple[Request, str] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._work, name="hand", daemon=True)
        self._thread.start()

    def do(self, request: Request, words: str) -> None:
        """Have something done; returns at once."""
        self._wanted.put((request, words))

    def close(self) -> None:
        """Send the hand home; what it does is not waited for."""
        self._wanted.put(None)
        self._operator.close()

    def _work(self) -> None:
        while (wanted := self._wanted.get()) is not None:
            request, words = wanted
            self._tell(HandAtWork(doing=words))
            try:
                self._operator.ask(request)
            except (ArmodalError, OSError, ValueError) as error:
                self._tell(HandIdle(trouble=str(error)))
            else:
                self._tell(HandIdle())
