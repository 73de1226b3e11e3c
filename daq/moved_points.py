"""Points moved in a session: taken as long as nothing was accepted at them."""

from __future__ import annotations

from collections.abc import Iterable

from armodal.daq.commands import MovePoint
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError
from armodal.protocols.plan_records import Plan
from armodal.protocols.session.moved_points import arm_with_point, move_note

__all__ = ["MovedPoints"]


class MovedPoints:
    """The arm with the points where they are measured.

    Attributes
    ----------
    arm
        As the session knows it.
    """

    def __init__(self, arm: Arm, plan: Plan) -> None:
        self.arm = arm
        self._plan = plan

    def take(self, command: MovePoint, measured: Iterable[str]) -> tuple[str, bool]:
        """Move a point, or say why not; the note for the journal, and whether it was moved.

        Parameters
        ----------
        measured
            Roving points of accepted hits.
        """
        point = command.point
        roving = set(measured)
        if point.id in roving or (roving and point.id == self._plan.fixed_point):
            said = f"point {point.id} has accepted hits and stays where it is: take them back first"
            return said, False
        try:
            self.arm = arm_with_point(self.arm, point)
        except ArmError as problem:
            return f"point {point.id} was not moved: {problem}", False
        return move_note(point), True
