"""The room an arm's plan is made in, from its bodies and what it has to stay out of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.own_arm.collisions import Collisions
from armodal.analyzer.own_arm.floor import floor_below, reach_of
from armodal.analyzer.planning.room import Room
from armodal.protocols.arm.records import Arm

__all__ = ["ArmRoom", "room_of_arm"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmRoom:
    """The room, and what it was made of."""

    room: Room
    collisions: Collisions
    drawn: bool  # whether shapes of links are the arm's own; capsules else
    base_drawn: bool


def room_of_arm(arm: Arm, bodies: Sequence[ArmBody], *, floor_m: float | None) -> ArmRoom:
    """Make the room of an arm.

    Parameters
    ----------
    bodies
        The arm's, base first.
    floor_m
        Height of a floor in the base's frame; None where the arm's keep-outs say all.
    """
    keep_outs = list(arm.keep_outs)
    if floor_m is not None:
        keep_outs.append(floor_below(reach_of(arm), floor_m))
    collisions = Collisions(arm, bodies, keep_outs)
    drawn = all(body.drawn for body in bodies[1:])
    everywhere = frozenset(point.id for point in arm.points)
    return ArmRoom(
        room=Room(
            free=collisions.clear,
            # A capsule that stands for a link says nothing of its faces.
            reachable=lambda q: collisions.reachable(q, arm.points) if drawn else everywhere,
            path_clear=collisions.path_clear,
        ),
        collisions=collisions,
        drawn=drawn,
        base_drawn=bodies[0].drawn,
    )
