"""A selective test plan: one posture for every joint, the fewest first, then the most telling."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.planning.clearance import Clearance, clear_postures
from armodal.analyzer.planning.equations import Equations, PlannedArm
from armodal.analyzer.planning.excitation import (
    HitChoice,
    PostureModes,
    best_hits,
    observable_joints,
    observing_points,
    posture_modes,
)
from armodal.analyzer.planning.expected import Instruments, expected_std, information
from armodal.analyzer.planning.room import Room
from armodal.analyzer.planning.search import isolating_postures
from armodal.analyzer.planning.selectivity import coupling_ratios, separable_set, worst_coupling
from armodal.analyzer.workspace.postures import random_postures
from armodal.analyzer.workspace.spectrum import ElasticJoints
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import EstimateError

__all__ = [
    "GravityCheck",
    "PlannedTest",
    "SelectivePlan",
    "describe_tests",
    "plan_tests",
    "seen_only_by",
]

Array = npt.NDArray[np.float64]

DOMINATED = 0.8  # of a mode's strain energy: the joint's own mode
N_OTHERS = 40  # random postures from which further tests are taken
ANOTHER_RAD = 0.35  # 20 degrees of any joint
WITH_VALIDATION = 4  # tests of which one can be spared: three are left to fit
# Where the arm's bodies are looked at themselves.
ANYWHERE = Clearance(floor_m=-np.inf, margin_m=0.0, base_radius_m=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class GravityCheck:
    """Gravity beside the springs, per elastic joint (file 002, end of section 3)."""

    torque_n_m: Array  # (n,) that holds the arm
    stiffness_n_m_per_rad: Array  # (n,) diagonal of dg/dq
    part_of_spring: Array  # (n,) of it, relative to k


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedTest:
    """One posture and hit, and what they are good for."""

    joints_rad: Array  # (n_joints,)
    target: int  # elastic joint (0-based among the arm's joints) it is for
    serves: tuple[int, ...]  # joints whose own mode its hit shows, of the arm's
    separable: tuple[int, ...]  # smallest set of joints around the target that is tied together
    coupling: Array  # (n,) |M_ij| / M_ii of the target to each elastic joint
    modes: PostureModes
    hit: HitChoice
    mode: int  # that the hit is chosen for
    points: tuple[str, ...]  # that see it
    gravity: GravityCheck
    reachable: frozenset[str] | None = None  # points a hand reaches; None where not looked at


@dataclass(frozen=True, slots=True, kw_only=True)
class SelectivePlan:
    """Tests hit at one point, the fewest that serve all joints first, then those that add most.

    Attributes
    ----------
    n_needed
        How many of `tests` isolate every joint that can be isolated.
    expected_std
        (n_fitted, n) relative standard deviation of each k after each test that is fitted.
    """

    planned: PlannedArm
    tests: tuple[PlannedTest, ...]
    n_needed: int
    expected_std: Array
    hit_point: str
    not_isolated: tuple[int, ...]  # joints (of the arm's) whose own mode no test shows
    most_selective: Array  # (n, n_joints) the posture of least coupling for each elastic joint
    least_coupling: Array  # (n,) its largest |M_ij| / M_ii

    @property
    def arm(self) -> Arm:
        """The arm without effects; the bodies they put on links are in the links."""
        return self.planned.arm

    @property
    def elastic(self) -> ElasticJoints:
        """The joints whose stiffness is asked."""
        return self.planned.elastic

    @property
    def n_fitted(self) -> int:
        """How many tests are fitted; the last of four or more is for validation, if not needed."""
        spare = len(self.tests) > self.n_needed and len(self.tests) >= WITH_VALIDATION
        return len(self.tests) - spare


def plan_tests(
    planned: PlannedArm,
    rng: np.random.Generator,
    *,
    clearance: Clearance | None = None,
    room: Room | None = None,
    instruments: Instruments | None = None,
    n_tests: int = 6,
    progress: Callable[[int, int], None] | None = None,
) -> SelectivePlan:
    """Find a selective test plan.

    Parameters
    ----------
    clearance
        What joint origins and points have to stay clear of, where `room` is not given.
    room
        Which postures the arm's bodies leave free, and which points can be reached in them.
    n_tests
        Wanted in all. More come if more are needed; from four on the last is none of these, since
        it is kept for validation.

    Raises
    ------
    EstimateError
        If no posture is clear of floor and base, or no point takes a hit for every joint.
    """
    elastic, n_joints = planned.elastic, len(planned.elastic.joints)
    tools = instruments or Instruments()
    if clearance is None:
        clearance = Clearance() if room is None else ANYWHERE
    free = None if room is None else room.free
    found = isolating_postures(planned, clearance, rng, progress, free=free)
    by_point = _candidates(planned, found, tools.least_mass_kg, room)
    covers = {
        point: _fewest(tests, elastic.joints)
        for point, tests in by_point.items()
        if {test.target for test in tests} == set(elastic.joints)
    }
    if not covers:
        raise EstimateError(
            f"no test point of arm '{planned.arm.name}' takes a hit for every joint: a hit of "
            f"{tools.force_peak_n:g} N would drive the accelerometer past "
            f"{tools.acceleration_range:g} m/s²; add points on heavier links, or a softer hammer"
        )
    hit_point = min(covers, key=lambda point: _cost(covers[point], elastic.joints))
    tests = covers[hit_point]
    served = {joint for test in tests for joint in test.serves}
    needed = len(tests)
    wanted = max(n_tests, needed + 1) if n_tests >= WITH_VALIDATION else n_tests
    known = [_told(planned, test, tools) for test in tests]
    others = random_postures(planned.arm, N_OTHERS, rng, still=(0,))
    others = others[clear_postures(planned.batch, others, clearance)]
    if room is not None:
        others = others[room.free(others)]
    rest = [
        (test, _told(planned, test, tools))
        for q in others
        for joint in elastic.joints
        for test in _tests_in(planned, q, joint, tools.least_mass_kg, room)
        if test.hit.point == hit_point
    ]
    while len(tests) < wanted:
        rest = [(test, extra) for test, extra in rest if _differs(test, tests)]
        if not rest:
            break
        gains = [float(np.log(expected_std([*known, extra], n_joints)).sum()) for _, extra in rest]
        test, extra = rest.pop(int(np.argmin(gains)))
        tests.append(test)
        known.append(extra)
    plan = SelectivePlan(
        planned=planned,
        tests=tuple(tests),
        n_needed=needed,
        expected_std=np.array([expected_std(known[: i + 1], n_joints) for i in range(len(tests))]),
        hit_point=hit_point,
        not_isolated=tuple(joint for joint in elastic.joints if joint not in served),
        most_selective=np.array([postures[0] for postures in found]),
        least_coupling=np.array([_coupling(planned, i, found[i][0]) for i in range(len(found))]),
    )
    return replace(plan, expected_std=plan.expected_std[: plan.n_fitted])


def seen_only_by(
    plan: SelectivePlan, points: Sequence[Sequence[str]], instruments: Instruments
) -> SelectivePlan:
    """The plan with what is to be expected if in each test only these points are measured."""
    tests = tuple(
        replace(test, points=tuple(point for point in test.points if point in measured))
        for test, measured in zip(plan.tests, points, strict=True)
    )
    known = [_told(plan.planned, test, instruments) for test in tests[: plan.n_fitted]]
    n_joints = len(plan.elastic.joints)
    expected = np.array([expected_std(known[: i + 1], n_joints) for i in range(len(known))])
    return replace(plan, tests=tests, expected_std=expected)


def describe_tests(
    planned: PlannedArm,
    joints_rad: Array,
    target: int,
    *,
    least_mass_kg: float = 0.0,
) -> list[PlannedTest]:
    """Work out what a posture is good for, hit at every moving point, the best hit first.

    Parameters
    ----------
    target
        The joint (0-based, of the arm's) the test is for; one of the elastic ones.
    least_mass_kg
        Hits that meet less are left out: they overload the accelerometer.
    """
    elastic, at = planned.elastic, planned.at(joints_rad)
    modes = posture_modes(at)
    number = elastic.joints.index(target)
    mode = modes.mode_of(number)
    points = observing_points(planned, at, modes, mode)
    gravity = _gravity(planned, at, joints_rad)
    separable = tuple(elastic.joints[i] for i in separable_set(modes.mass, number))
    own = [
        joint
        for i, joint in enumerate(elastic.joints)
        if modes.joint_share[i, modes.mode_of(i)] >= DOMINATED
        and modes.mode_of(i) not in {modes.mode_of(j) for j in range(len(elastic.joints)) if j != i}
    ]
    return [
        PlannedTest(
            joints_rad=joints_rad,
            target=target,
            serves=observable_joints(elastic, modes, own, hit),
            separable=separable,
            coupling=coupling_ratios(modes.mass[..., None])[number, :, 0],
            modes=modes,
            hit=hit,
            mode=mode,
            points=points,
            gravity=gravity,
        )
        for hit in best_hits(planned, at, modes, mode, least_mass_kg=least_mass_kg)
        if hit.effective_mass_kg >= least_mass_kg
    ]


def _told(planned: PlannedArm, test: PlannedTest, instruments: Instruments) -> Array:
    return information(
        planned,
        planned.at(test.joints_rad),
        hit_point=test.hit.point,
        hit_direction=test.hit.direction_base,
        points=test.points,
        instruments=instruments,
    )


def _candidates(
    planned: PlannedArm,
    found: list[Array],
    least_mass_kg: float,
    room: Room | None,
) -> dict[str, list[PlannedTest]]:
    """Tests by the point they hit: one plan hits one point."""
    by_point: dict[str, list[PlannedTest]] = {}
    for joint, postures in zip(planned.elastic.joints, found, strict=True):
        for q in postures:
            for test in _tests_in(planned, q, joint, least_mass_kg, room):
                by_point.setdefault(test.hit.point, []).append(test)
    return by_point


def _tests_in(
    planned: PlannedArm,
    joints_rad: Array,
    target: int,
    least_mass_kg: float,
    room: Room | None,
) -> list[PlannedTest]:
    """Tests of a posture whose hit a hammer can reach, with the points a hand can."""
    tests = describe_tests(planned, joints_rad, target, least_mass_kg=least_mass_kg)
    if room is None:
        return tests
    near = room.reachable(joints_rad)
    tests = [
        replace(test, points=tuple(point for point in test.points if point in near), reachable=near)
        for test in tests
        if test.hit.point in near
    ]
    return [test for test in tests if test.points]


def _cost(tests: list[PlannedTest], joints: tuple[int, ...]) -> tuple[int, int, float]:
    """Joints not shown, then tests, then how impure the tests are."""
    served = {joint for test in tests for joint in test.serves}
    return (len(joints) - len(served), len(tests), -min(_merit(test) for test in tests))


def _fewest(candidates: list[PlannedTest], joints: tuple[int, ...]) -> list[PlannedTest]:
    """Greedy cover: the test that shows most joints still missing, the best of equals.

    A joint no test shows alone still gets its best posture: the fit of all modes needs it.
    """
    tests: list[PlannedTest] = []
    missing = set(joints)
    while missing:
        best = max(candidates, key=lambda c: (len(missing & set(c.serves)), _merit(c)))
        gained = missing & set(best.serves)
        if not gained:
            break
        tests.append(best)
        missing -= gained
    return tests + [
        max((c for c in candidates if c.target == joint), key=_merit) for joint in sorted(missing)
    ]


def _differs(test: PlannedTest, others: list[PlannedTest]) -> bool:
    """Whether a posture is another one, and no step beside one already planned."""
    return all(np.abs(test.joints_rad - other.joints_rad).max() > ANOTHER_RAD for other in others)


def _coupling(planned: PlannedArm, number: int, joints_rad: Array) -> float:
    return float(worst_coupling(planned.joint_mass(joints_rad[None]))[number, 0])


def _merit(test: PlannedTest) -> float:
    """Purity of the hit, lowered by the largest coupling."""
    return test.hit.purity * (1.0 - min(1.0, float(test.coupling.max())))


def _gravity(planned: PlannedArm, at: Equations, joints_rad: Array) -> GravityCheck:
    torque = planned.batch.gravity_torque(joints_rad[None])[list(planned.elastic.joints), 0]
    return GravityCheck(
        torque_n_m=torque,
        stiffness_n_m_per_rad=at.joint_gravity,
        part_of_spring=at.joint_gravity / planned.elastic.stiffness_n_m_per_rad,
    )
