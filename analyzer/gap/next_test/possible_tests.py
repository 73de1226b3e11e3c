"""Tests that a laboratory can do: postures, hits and their levels, brakes, a known mass."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.protocols.plan_records import KnownMass

__all__ = ["Doable", "Test", "possible_tests"]

Array = npt.NDArray[np.float64]

_N_POSTURES = 14
_PART_OF_RANGE = 0.8
_REACH_RAD = 1.6  # a posture further from those measured nobody would move to
_MASS = 0.03  # of the arm's, bolted to its last link
_STATES = 3  # postures in which brakes, masses, levels and the base are tried
_SOFTER, _HARDER = (1.5, 2.5), 1.5  # times: harder may overdrive the sensor
_N_NEAR, _NEAR_RAD = 6, 0.35  # postures about one, and how far each joint is from it


@dataclass(frozen=True, slots=True, kw_only=True)
class Test:
    """A posture to measure in, and how."""

    __test__ = False  # no test of pytest's

    joints_rad: Array  # (n_joints,)
    hit_direction: Array  # (3,) unit, base frame
    hit_point: str | None = None  # None: where the session was hit
    more_points: tuple[str, ...] = ()  # for the sensor, beside the session's
    peaks_n: tuple[float, ...] = ()  # wanted, one a hit; empty: as in the session
    brakes: bool = False
    known_mass: KnownMass | None = None

    @property
    def words(self) -> str:
        """Return what to do."""
        angles = ", ".join(f"{round(a) + 0.0:.0f}" for a in np.rad2deg(self.joints_rad))
        hit = ", ".join(f"{round(x, 2) + 0.0:+.2f}" for x in self.hit_direction)
        where = "hits" if self.hit_point is None else f"hits on point {self.hit_point}"
        words = f"measure all points with the joints at {angles} deg, {where} along ({hit}) in base"
        if self.more_points:
            words += f", and points {', '.join(self.more_points)}"
        if self.peaks_n:
            words += f", hits of about {', '.join(f'{peak:.0f}' for peak in self.peaks_n)} N"
        if self.brakes:
            words += ", the brakes on"
        if self.known_mass is not None:
            body = self.known_mass
            at_mm = ", ".join(f"{1e3 * x:.0f}" for x in body.center_m)
            words += (
                f", {body.mass_kg:.1f} kg bolted to {body.link}, its centre at {at_mm} mm there"
            )
        return words


@dataclass(frozen=True, slots=True, kw_only=True)
class Doable:
    """What a laboratory can choose for a test of an arm."""

    stage: Stage
    measured: tuple[PostureLines, ...]  # soft and hard hits of a posture are one
    low_rad: Array  # (n_joints,)
    high_rad: Array
    directions: tuple[Array, ...]  # of hits where the session was hit; the first is its own
    hit_points: tuple[int, ...]  # others, one on every moving link that was not hit
    base_points: tuple[str, ...]  # that the session left out
    mass: KnownMass | None
    fit: Fit

    @classmethod
    def of(cls, stage: Stage, fit: Fit) -> Doable:
        """What can be done with the arm of a session."""
        arm = fit.hypothesis.ordinary.superset.arm
        measured = tuple({own.name: own for own in stage.lines}.values())
        low, high = np.array([joint.range_rad for joint in arm.joints]).T
        middle, half = (low + high) / 2.0, _PART_OF_RANGE * (high - low) / 2.0
        near = np.mean([own.joints_rad for own in measured], axis=0)
        last = arm.joints[-1].link
        mass_kg = round(_MASS * sum(joint.link.mass_kg for joint in arm.joints), 1)
        body = KnownMass(link=last.name, mass_kg=mass_kg, center_m=np.asarray(last.center_m))
        return cls(
            stage=stage,
            measured=measured,
            low_rad=np.maximum(middle - half, near - _REACH_RAD),
            high_rad=np.minimum(middle + half, near + _REACH_RAD),
            directions=(measured[0].hit_direction[0], *np.eye(3)),
            hit_points=_other_points(measured, fit),
            base_points=_base_points(measured, fit),
            mass=body if mass_kg > 0.0 else None,
            fit=fit,
        )

    def hit_on(self, test: Test, point: int) -> Test:
        """Return a test hit on another point, square to the surface its sensor stands on."""
        superset = self.fit.hypothesis.ordinary.superset
        inward = -superset.posture(test.joints_rad).point_rotation[point][:, 2]
        name = superset.arm.points[point].id
        return replace(test, hit_direction=inward, hit_point=name)

    def peaks_n(self, like: PostureLines) -> list[tuple[float, ...]]:
        """Peaks of a posture's softest and hardest hits, further apart, and the one between.

        None where the level tells nothing.
        """
        if not like.level:
            return []
        peaks = [own.peak_n for own in self.stage.lines if own.name == like.name]
        hard = max(peaks) * _HARDER
        softs = [min(peaks) / softer for softer in _SOFTER]
        return [(soft, float(np.sqrt(soft * hard)), hard) for soft in softs]

    def beside(self, test: Test, rng: np.random.Generator) -> Iterator[Test]:
        """Tests that differ from one in a single choice."""
        for _ in range(_N_NEAR):
            moved = test.joints_rad + _NEAR_RAD * rng.standard_normal(len(test.joints_rad))
            posed = replace(test, joints_rad=np.clip(moved, self.low_rad, self.high_rad))
            index = self.fit.hypothesis.ordinary.superset.point_index
            yield posed if test.hit_point is None else self.hit_on(posed, index[test.hit_point])
        for direction in self.directions:
            if test.hit_point is not None or np.any(direction != test.hit_direction):
                yield replace(test, hit_direction=np.asarray(direction), hit_point=None)
        for point in self.hit_points:
            hit = self.hit_on(test, point)
            if hit.hit_point != test.hit_point:
                yield hit
        for peaks in self.peaks_n(self.measured[0]):
            if peaks != test.peaks_n:
                yield replace(test, peaks_n=peaks)
        if self.base_points and not test.more_points:
            yield replace(test, more_points=self.base_points)
        if not test.brakes:
            yield replace(test, brakes=True)
        if self.mass is not None and test.known_mass is None:
            yield replace(test, known_mass=self.mass)


def possible_tests(stage: Stage, fit: Fit, *, rng: np.random.Generator) -> list[Test]:
    """Tests of every kind that a laboratory can do, each new in one way.

    Other postures, hits and levels, brakes, a known mass. Points of the base that the session left
    out are measured too, in some of its postures; where soft and hard hits are apart, others are
    softer and harder.
    """
    can = Doable.of(stage, fit)
    tests = []
    for i in range(_N_POSTURES):
        posture = can.low_rad + (can.high_rad - can.low_rad) * rng.random(len(can.low_rad))
        direction = can.directions[i % len(can.directions)]
        tests.append(Test(joints_rad=posture, hit_direction=np.asarray(direction)))
    plain = [
        Test(joints_rad=own.joints_rad, hit_direction=own.hit_direction[0]) for own in can.measured
    ]
    tests += [can.hit_on(own, point) for own, point in zip(plain, can.hit_points, strict=False)]
    some = list(zip(plain, can.measured, strict=True))[:_STATES]
    for own, lines in some:
        if can.base_points:
            tests.append(replace(own, more_points=can.base_points))
        tests += [replace(own, peaks_n=peaks) for peaks in can.peaks_n(lines)[:1]]
    for own, _ in some:
        tests.append(replace(own, brakes=True))
        if can.mass is not None:
            tests.append(replace(own, known_mass=can.mass))
    return tests


def _other_points(measured: Sequence[PostureLines], fit: Fit) -> tuple[int, ...]:
    """One on every moving link that was not hit, beyond the others' first."""
    was_hit = set(measured[0].hit_point.tolist())
    links = fit.hypothesis.ordinary.superset.point_link
    hit_links = {links[point] for point in was_hit}
    first: dict[int, int] = {}
    for point in np.unique(measured[0].sensor_point).tolist():
        if links[point] >= 0 and links[point] not in hit_links:
            first.setdefault(int(links[point]), point)
    return tuple(first[link] for link in sorted(first, reverse=True))


def _base_points(measured: Sequence[PostureLines], fit: Fit) -> tuple[str, ...]:
    """Those the sensor was not at; none where the hammer moves and the sensor stays."""
    if len(measured[0].hit_point) > 1:
        return ()
    superset = fit.hypothesis.ordinary.superset
    seen = set(measured[0].sensor_point.tolist())
    at_base = np.flatnonzero(np.asarray(superset.point_link) < 0).tolist()
    return tuple(superset.arm.points[point].id for point in at_base if point not in seen)
