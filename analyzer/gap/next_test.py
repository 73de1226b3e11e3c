"""The one further test that would tell most: of rivals that stand, or of what could hide.

For data that one rival would give in a new test, the log density under each rival integrates over
what its fit left open (`analyzer.gap.held_out`). The difference is the evidence that the test is
expected to bring for the true one; a test is as good as its worst pair of rivals, whichever is
true.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from typing import Any

import numpy as np
import numpy.typing as npt

from analyzer.arm.superset import Superset
from analyzer.gap.fit import Fit, Stage, better_start, fit_hypothesis
from analyzer.gap.hypothesis import Hypothesis
from analyzer.gap.lines import PostureLines
from analyzer.gap.posed import PosedModel
from analyzer.gap.scan import Candidate
from analyzer.gap.space import Parameter, Space
from analyzer.gap.weigh import Discrepancy, Weighing
from protocols.plan_records import KnownMass

__all__ = [
    "Test",
    "evidence_brought",
    "expected_evidence",
    "hidden_rival",
    "possible_tests",
    "proposed",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

NAME = "next"
_N_POSTURES = 14
_PART_OF_RANGE = 0.8
_MASS = 0.03  # of the arm's, bolted to its last link
_STATES = 3  # postures in which brakes and masses are tried
_PINNED = 0.02  # of a hidden size: how firmly it is held
_STEPS, _STEPS_AGAIN = 6, 12


@dataclass(frozen=True, slots=True, kw_only=True)
class Test:
    """A posture to measure in, and how."""

    __test__ = False  # no test of pytest's

    joints_rad: Array  # (n_joints,)
    hit_direction: Array  # (3,) unit, base frame
    hit_point: str | None = None  # None: where the session was hit
    brakes: bool = False
    known_mass: KnownMass | None = None

    @property
    def words(self) -> str:
        """Return what to do."""
        angles = ", ".join(f"{a:.0f}" for a in np.rad2deg(self.joints_rad))
        hit = ", ".join(f"{x:+.2f}" for x in self.hit_direction)
        where = "hits" if self.hit_point is None else f"hits on point {self.hit_point}"
        words = f"measure all points with the joints at {angles} deg, {where} along ({hit}) in base"
        if self.brakes:
            words += ", the brakes on"
        if self.known_mass is not None:
            body = self.known_mass
            words += f", {body.mass_kg:.1f} kg bolted to {body.link}"
        return words


def possible_tests(stage: Stage, fit: Fit, *, rng: np.random.Generator) -> list[Test]:
    """What a laboratory can do: other postures, other hits, brakes, a known mass.

    Other points are hit square to the surface their sensors stand on.
    """
    superset = fit.hypothesis.ordinary.superset
    arm = superset.arm
    # Soft and hard hits are of one posture.
    measured = list({own.name: own for own in stage.lines}.values())
    directions = [measured[0].hit_direction[0], *np.eye(3)]
    low, high = np.array([joint.range_rad for joint in arm.joints]).T
    middle, half = (low + high) / 2.0, _PART_OF_RANGE * (high - low) / 2.0
    # A posture nobody would move to tells no more: within a right angle of those measured.
    near = np.mean([own.joints_rad for own in measured], axis=0)
    low, high = np.maximum(middle - half, near - 1.6), np.minimum(middle + half, near + 1.6)
    tests = []
    for i in range(_N_POSTURES):
        posture = low + (high - low) * rng.random(len(low))
        direction = directions[i % len(directions)]
        tests.append(Test(joints_rad=posture, hit_direction=np.asarray(direction)))
    for own, point in zip(measured, _other_points(measured, fit), strict=False):
        inward = -superset.posture(own.joints_rad).point_rotation[point][:, 2]
        name = arm.points[point].id
        tests.append(Test(joints_rad=own.joints_rad, hit_direction=inward, hit_point=name))
    last = arm.joints[-1].link
    body = KnownMass(
        link=last.name,
        mass_kg=round(_MASS * sum(joint.link.mass_kg for joint in arm.joints), 1),
        center_m=np.asarray(last.center_m),
    )
    for own in measured[:_STATES]:
        plain = Test(joints_rad=own.joints_rad, hit_direction=own.hit_direction[0])
        tests.append(replace(plain, brakes=True))
        if body.mass_kg > 0.0:
            tests.append(replace(plain, known_mass=body))
    return tests


def _other_points(measured: Sequence[PostureLines], fit: Fit) -> list[int]:
    """One on every moving link that was not hit, beyond the others' first."""
    was_hit = set(measured[0].hit_point.tolist())
    links = fit.hypothesis.ordinary.superset.point_link
    hit_links = {links[point] for point in was_hit}
    first: dict[int, int] = {}
    for point in np.unique(measured[0].sensor_point).tolist():
        if links[point] >= 0 and links[point] not in hit_links:
            first.setdefault(int(links[point]), point)
    return [first[link] for link in sorted(first, reverse=True)]


def proposed(
    stage: Stage,
    rivals: Sequence[Fit],
    *,
    rng: np.random.Generator,
    tests: Sequence[Test] | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> tuple[Test, float] | None:
    """The test of most evidence between rivals, and how much in nats; None where there is one."""
    if len(rivals) < 2:
        return None
    tell("the next test")
    candidates = possible_tests(stage, rivals[0], rng=rng) if tests is None else tests
    gains = [expected_evidence(stage, rivals, test) for test in candidates]
    best = int(np.argmax(gains))
    return candidates[best], float(gains[best])


def expected_evidence(stage: Stage, rivals: Sequence[Fit], test: Test) -> float:
    """Least evidence, over which rival is true and against which, that a test is expected to bring.

    Parameters
    ----------
    stage
        The sharp lines; scatter and points are taken to be as in its first posture.
    """
    superset = rivals[0].hypothesis.ordinary.superset
    model = PosedModel(superset, test.joints_rad)
    blank = _lines(superset, stage.lines[0], test)
    ready = [_Ready.of(rival) for rival in rivals]
    slopes = [model.derivatives(r.hypothesis, blank, r.space, r.values) for r in ready]
    least = np.inf
    for true, other in permutations(range(len(ready)), 2):
        would = slopes[true][0]
        size = float(np.mean(np.abs(would) ** 2) / np.mean(np.abs(blank.values) ** 2))
        lines = replace(blank, values=would, variance=blank.variance * size)
        weighing = Weighing(lines, superset.arm.tolerances, Discrepancy())
        surprise = [_surprise(weighing, ready[i], *slopes[i]) for i in (true, other)]
        least = min(least, surprise[1] - surprise[0])
    return float(least)


def evidence_brought(one: Fit, other: Fit, stage: Stage) -> float:
    """Evidence for one hypothesis against another that further lines brought, both fitted again.

    Parameters
    ----------
    stage
        The lines both were fitted to, and those of a further test.
    """
    brought = []
    for fit in (one, other):
        postures = tuple(dict.fromkeys(lines.name for lines in stage.lines))
        ordinary = replace(fit.hypothesis.ordinary, postures=postures)
        more = replace(fit.hypothesis, ordinary=ordinary)
        again = fit_hypothesis(stage, more, start=fit.values, max_iterations=_STEPS_AGAIN)
        brought.append(again.evidence - fit.evidence)
    return brought[1] - brought[0]


def hidden_rival(stage: Stage, final: Fit, candidate: Candidate, change: float) -> Fit:
    """The final model with an effect that could hide in it, held at a size it could have.

    Parameters
    ----------
    change
        Of the size, from what the final model has of it.
    """
    instance, present = candidate.instance, final.hypothesis
    name = instance.size
    size = final.values.get(name, 0.0) + change

    def firm(p: Parameter) -> Parameter:
        return replace(p, mean=size, std=_PINNED * abs(change), start=size)

    begin = {n: final.values[n] + per * change for n, per in candidate.follow.items()}
    begin = {**final.values, **{n: v for n, v in begin.items() if n in final.values}, name: size}
    if name in instance.relaxes:
        relaxes = {n: firm(p) if n == name else p for n, p in instance.relaxes.items()}
        pinned = replace(instance, relaxes=relaxes)
    else:
        parameters = [firm(p) if p.name == name else p for p in instance.parameters]
        pinned = replace(instance, parameters=tuple(parameters))
        begin = {**{p.name: p.first for p in parameters}, **begin}
    wider = Hypothesis(ordinary=present.ordinary, instances=(*present.instances, pinned))
    start = better_start(stage, wider, [begin, {**final.values, name: size}])
    return fit_hypothesis(stage, wider, start=start, max_iterations=_STEPS)


@dataclass(frozen=True, slots=True)
class _Ready:
    """A rival with the new posture among its own."""

    hypothesis: Hypothesis
    space: Space
    values: Mapping[str, float]
    curvature: Array  # of what its fit knows, priors included
    free: npt.NDArray[np.bool_]

    @classmethod
    def of(cls, fit: Fit) -> _Ready:
        ordinary = fit.hypothesis.ordinary
        more = replace(ordinary, postures=(*ordinary.postures, NAME))
        hypothesis = replace(fit.hypothesis, ordinary=more)
        space = hypothesis.space()
        values = space.values(space.start(fit.values))
        A = np.eye(len(space))
        at = np.array([space.index[name] for name in fit.space.index])
        A[np.ix_(at, at)] += fit.curvature
        free = np.ones(len(space), dtype=bool)
        free[at] = fit.free
        return cls(hypothesis, space, values, A, free)


def _lines(superset: Superset, like: PostureLines, test: Test) -> PostureLines:
    hit_point = like.hit_point[:1]
    if test.hit_point is not None:
        hit_point = np.array([superset.point_index[test.hit_point]])
    return replace(
        like,
        name=NAME,
        joints_rad=test.joints_rad,
        hit_direction=test.hit_direction[None],
        hit_point=hit_point,
        hit=np.zeros_like(like.hit),
        brakes=test.brakes,
        known_mass=test.known_mass,
    )


def _surprise(weighing: Weighing, ready: _Ready, y: ComplexArray, dy: ComplexArray) -> float:
    """-ln p of the lines, integrated over what the rival leaves open; up to a constant."""
    part = weighing.quadratic(y, dy)
    f = ready.free
    A = ready.curvature[np.ix_(f, f)]
    both = A + part.curvature[np.ix_(f, f)]
    g = part.gradient[f]
    log_dets = np.linalg.slogdet(both)[1] - np.linalg.slogdet(A)[1]
    return float(part.cost - 0.5 * g @ np.linalg.solve(both, g) + 0.5 * log_dets)
