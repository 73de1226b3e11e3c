"""A plan that can be run: free postures, ways between them, equipment, time, what it tells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.own_arm.bodies import ArmBody
from armodal.analyzer.own_arm.room_of_arm import room_of_arm
from armodal.analyzer.planning.clearance import Clearance
from armodal.analyzer.planning.duration import minutes as minutes_of
from armodal.analyzer.planning.duration import mounting_s
from armodal.analyzer.planning.equations import planned_arm
from armodal.analyzer.planning.equipment import Chosen, chosen_equipment
from armodal.analyzer.planning.fewer_points import fewer_points
from armodal.analyzer.planning.measured_points import measured_points
from armodal.analyzer.planning.plan_text import plan_text
from armodal.analyzer.planning.room import Room
from armodal.analyzer.planning.route import Leg, route, wound
from armodal.analyzer.planning.selective import SelectivePlan, plan_tests, seen_only_by
from armodal.analyzer.planning.tolerance import inertia_std
from armodal.analyzer.workspace.postures import random_postures
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import EstimateError, PlanError
from armodal.protocols.plan import plan_from_text
from armodal.protocols.sensors_file import Equipment

__all__ = ["MadePlan", "made_plan"]

Array = npt.NDArray[np.float64]

_N_LOOKED = 400  # random postures of which the free ones tell the arm's scale


@dataclass(frozen=True, slots=True, kw_only=True)
class MadePlan:
    """A plan with everything that is to be known before it is run.

    Attributes
    ----------
    plan : SelectivePlan
        Tests with posture, point and direction of the hits, and what each tells.
    text : str
        A plan file, `docs/plan-file.md`.
    equipment : Chosen
        Hammer, accelerometer, hits (N, s) and trigger level (N).
    legs : tuple of Leg
        Ways from each posture to the next, joint angles in rad.
    minutes : float
        Duration of all tests.
    mountings : int
        Of a sensor, in all tests.
    inertia_std : (n,) array
        Relative deviation of the k of each elastic joint by the arm's tolerances alone.
    touching : tuple of str
        Pairs of bodies that meet in all postures, which are not checked.
    by_capsules : bool
        Whether capsules stand for links of which nothing is drawn.
    """

    plan: SelectivePlan
    text: str
    equipment: Chosen
    legs: tuple[Leg, ...]
    minutes: float
    mountings: int
    inertia_std: Array
    touching: tuple[str, ...]
    by_capsules: bool


def made_plan(
    arm: Arm,
    rng: np.random.Generator,
    *,
    name: str,
    bodies: Sequence[ArmBody],
    floor_m: float | None,
    equipment: Equipment,
    n_tests: int,
    minutes: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> MadePlan:
    """Find a plan that can be run.

    Parameters
    ----------
    bodies
        The arm's, base first (`bodies_of_arm`).
    floor_m
        Height of the floor; where it is None the arm's keep-outs, and without any a floor at 0.
    n_tests
        As in `plan_tests`.
    minutes
        The plan may take; where all points take longer, fewer are measured (`fewer_points`).

    Raises
    ------
    ArmError
        If no joint is elastic, or an effect of the arm is not the library's or lacks a parameter.
    EstimateError
        If no posture is free, or no point takes a hit for every joint.
    PlanError
        If no accelerometer fits, or the fewest points take longer than `minutes`.
    """
    planned = planned_arm(arm)
    arm = planned.arm
    floor = floor_m if floor_m is not None or arm.keep_outs else 0.0
    found = room_of_arm(arm, bodies, floor_m=floor)
    room: Room = found.room
    postures = random_postures(arm, _N_LOOKED, rng)
    postures = postures[room.free(postures)]
    if not len(postures):
        met = found.collisions.met(random_postures(arm, 1, rng)[0])
        raise EstimateError(
            f"no posture of arm '{arm.name}' is free: in one tried {', '.join(met)} meet; check "
            "the joints' ranges, the keep-outs and the floor"
        )
    chosen = chosen_equipment(planned, postures, equipment)
    clearance = None
    if not found.base_drawn:
        clearance = Clearance(floor_m=0.0 if floor is None else floor)
    plan = plan_tests(
        planned,
        rng,
        clearance=clearance,
        room=room,
        instruments=chosen.instruments,
        n_tests=n_tests,
        progress=progress,
    )
    plan = _wound(plan)
    legs = route(arm, [test.joints_rad for test in plan.tests], room, rng)
    points = measured_points(plan)
    text = plan_text(plan, name, points=points, equipment=chosen, legs=legs)
    written = plan_from_text(text, arm)
    if minutes is not None and minutes_of(written) > minutes:
        too_many = np.ceil(60.0 * (minutes_of(written) - minutes) / mounting_s(written))
        points = fewer_points(plan, points, int(too_many))
        plan = seen_only_by(plan, points, chosen.instruments)
        text = plan_text(plan, name, points=points, equipment=chosen, legs=legs)
        written = plan_from_text(text, arm)
        if minutes_of(written) > minutes:
            least = np.ceil(minutes_of(written))
            raise PlanError(
                f"wanted a plan of at most {minutes:g} minutes, got {least:.0f} for "
                f"{len(plan.tests)} tests with the fewest points that still show how every link "
                f"moves; ask `armodal plan` for fewer --tests, or for --minutes {least:.0f}"
            )
    collisions = found.collisions
    return MadePlan(
        plan=plan,
        text=text,
        equipment=chosen,
        legs=legs,
        minutes=minutes_of(written),
        mountings=sum(len(posture.points) for posture in written.postures),
        inertia_std=inertia_std(plan),
        touching=tuple(
            f"{collisions.name(a)} and {collisions.name(b)}" for a, b in collisions.touching
        ),
        by_capsules=not found.drawn,
    )


def _wound(plan: SelectivePlan) -> SelectivePlan:
    """The same postures, each with its joints turned as near to the one before as can be."""
    near = np.array([0.5 * (low + high) for low, high in (j.range_rad for j in plan.arm.joints)])
    tests = []
    for test in plan.tests:
        near = wound(plan.arm, test.joints_rad, near)
        tests.append(replace(test, joints_rad=near))
    return replace(plan, tests=tuple(tests))
