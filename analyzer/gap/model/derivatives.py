"""Derivatives of solved postures by every parameter, by name.

What an effect adds in a form that is known (`model.assembly`) has its derivative in closed
form; what is left has one by differences of the equations.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.hysteresis import hysteresis, lost_by_power_slope, relaxed_slope
from armodal.analyzer.gap.model.assembly import BASE, Assembly, rate_name, relaxing_name
from armodal.analyzer.gap.model.change import Change, by_change, by_decay
from armodal.analyzer.gap.model.geometry import GeometrySlopes, across, skew
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.line_arrays import as_single, real_times
from armodal.analyzer.gap.model.motion_derivatives import by_motion, by_slopes
from armodal.analyzer.gap.model.ordinary import LOSS_POWER, Ordinary
from armodal.analyzer.gap.model.response import Response
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.gap.model.system import System
from armodal.analyzer.gap.model.systems import (
    MotionSlopes,
    Slopes,
    angle_slopes,
    motion_slopes,
    systems,
)

__all__ = ["Solved"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]
NamesOfMountings = list[list[tuple[str, ...]]]  # (P, m, k)

_INERTIA_STEP = 1e-6
_RELATIVE_STEP = 1e-3  # of a parameter's prior deviation


@dataclass(frozen=True, slots=True)
class Solved:
    """Solved postures, and their derivatives (P, m, 3, L) by name."""

    hypothesis: Hypothesis
    plain: Sequence[Assembly]  # without effects
    assemblies: Sequence[Assembly]
    exact: Response
    values: Mapping[str, float]
    near: GeometrySlopes  # stacked
    single: bool = True  # derivatives in single precision where it is wide enough

    @property
    def found(self) -> Response:
        """Return what derivatives are made of."""
        return self.exact.for_derivatives if self.single else self.exact

    @property
    def ordinary(self) -> Ordinary:
        """Return the ordinary model."""
        return self.hypothesis.ordinary

    def by_equations(self) -> Iterator[tuple[str, ComplexArray]]:
        """What changes the equations, in forms that are known."""
        yield from self.by_joints()
        yield from self.by_compliances()
        yield from self.by_inertias()
        yield from self.by_angles()
        yield from self.by_terms()
        yield from self.by_turns()
        yield from self.by_motions()

    def by_joints(self) -> Iterator[tuple[str, ComplexArray]]:
        """Stiffness with all it loses, damping, losses, how one grows, where another is most."""
        s = self.found.s_rad_s
        turn = self.found.weight("loss")[:, None, None, :]
        by_loss = np.zeros_like(self.found.true_axes)
        by_spring: dict[str, tuple[ComplexArray, ComplexArray]] = {}
        rates = self.found.system.relaxing_rad_s.T
        for at, i in enumerate(self.ordinary.elastic):
            name = self.ordinary.arm.joints[i].name
            row = np.stack([own.joint_row(name) for own in self.assemblies])
            factors = np.array([own.factors.get(name, (1.0, 1.0)) for own in self.assemblies])
            k, c = (float(np.exp(self.values[f"ln {what} {name}"])) for what in "kc")
            by_stiffness = self.found.by_stretch(row, k * factors[:, :1])
            part = self.values[relaxing_name(name)]
            relaxes = self.found.relaxed[at][:, None, None, :]
            by_spring[name] = (
                (1.0 + self.values[f"loss {name}"] * turn + part * relaxes) * by_stiffness,
                self.found.by_stretch(row, c * factors[:, 1:] * s),
            )
            yield f"ln k {name}", by_spring[name][0]
            yield f"ln c {name}", by_spring[name][1]
            yield f"loss {name}", turn * by_stiffness
            yield relaxing_name(name), relaxes * by_stiffness
            by_rate = part * relaxed_slope(s, rates[at]).astype(s.dtype)
            yield rate_name(name), by_rate[:, None, None, :] * by_stiffness
            by_loss += self.values[f"loss {name}"] * by_stiffness
        if all(own.loss_power_is_free for own in self.assemblies):
            grows = lost_by_power_slope(s, self.found.system.loss_power).astype(s.dtype)
            yield LOSS_POWER, grows[:, None, None, :] * by_loss
        for parameter, (name, _, _) in self.assemblies[0].log_slopes.items():
            slopes = np.array([own.log_slopes[parameter][1:] for own in self.assemblies])
            by_k, by_c = as_single(slopes).T[:, :, None, None, None]
            yield parameter, by_k * by_spring[name][0] + by_c * by_spring[name][1]

    def by_compliances(self) -> Iterator[tuple[str, ComplexArray]]:
        """Compliances and their losses."""
        s = self.found.s_rad_s
        compliance = self.found.whole.compliance.astype(s.real.dtype)
        every = [at for parts in self.assemblies[0].compliance_of.values() for at, _ in parts]
        row_of = dict(zip(every, self.found.by_compliances(every), strict=True))
        for of_all in (
            [own.compliance_of for own in self.assemblies],
            [own.compliance_slopes for own in self.assemblies],
        ):
            for name, parts in of_all[0].items():
                weights = np.array([[weight for _, weight in own[name]] for own in of_all])
                yield name, _weighed_sum([row_of[at] for at, _ in parts], weights.T)
        resists, first = self.found.resists, self.assemblies[0]
        for by, at_parameter in ((s, first.loss_of), (hysteresis(s), first.loss_factor_of)):
            for name, coordinates in at_parameter.items():
                lags = (-compliance[:, at, None] * by / resists[..., at] for at in coordinates)
                rows = zip(coordinates, lags, strict=True)
                yield name, np.sum([row_of[at] * w[:, None, None, :] for at, w in rows], axis=0)

    def by_inertias(self) -> Iterator[tuple[str, ComplexArray]]:
        """Masses, centres and tensors of links; what is bolted to them; the base's own."""
        bolted = self.assemblies[0].inertia_of
        of_base = {name: slope for name, (at, slope) in bolted.items() if at == BASE}
        if of_base:
            by_base = self.found.by_base_inertia(np.array([*of_base.values()]))
            yield from zip(of_base, by_base, strict=True)
        for link in range(len(self.ordinary.arm.joints)):
            names = self.ordinary.inertia_names(link)
            changes = _inertia_changes(self.ordinary, link, names, self.values)
            more = {name: slope for name, (at, slope) in bolted.items() if at == link}
            if more:
                names, changes = (*names, *more), np.concatenate([changes, [*more.values()]])
            yield from zip(names, self.found.by_link_inertia(link, changes), strict=True)

    def by_measurement(self) -> Iterator[tuple[str, ComplexArray]]:
        """Gains, tilts and delay."""
        found = self.found
        y = found.values
        gains, turned = self.ordinary.sensor(self.values)
        # What effects made of the ordinary sensor's channels.
        beyond = found.system.mix @ np.linalg.inv(gains[:, None] * turned)
        for axis, letter in enumerate("xyz"):
            unit = np.eye(3)[axis]
            by_gain = unit[:, None] * gains[:, None] * turned
            by_tilt = gains[:, None] * skew(unit)
            for what, rows in (("ln gain", by_gain), ("tilt", by_tilt)):
                mixed = (beyond @ rows).astype(y.real.dtype)
                yield f"{what} {letter}", real_times(mixed, found.true_axes)
        yield "ln hammer", -y
        yield "delay", -found.s_rad_s[:, None, None, :] * y

    def by_hit_directions(self) -> Iterator[tuple[int, str, ComplexArray]]:
        """Aim of each posture's hits: derivatives (m, 3, L) there, elsewhere they do nothing."""
        found = self.found
        if found.system.hit.shape[1] == 1:
            sides = np.stack(
                [own.hit_turn @ across(own.lines.hit_direction[0]) for own in self.assemblies]
            )
            for side, letter in enumerate("ab"):
                by_hit_direction = found.by_forces(sides[:, None, :, side])
                for p, own in enumerate(self.assemblies):
                    yield p, f"aim {letter} {own.lines.name}", by_hit_direction[p]

    def by_hit_shifts(self) -> ComplexArray:
        """Derivatives (3, P, m, 3, L) by a shift of each mounting's hit along the axes there."""
        system, own = self.exact.system, self.assemblies
        found = []
        for axis in range(3):
            # Where it was struck in truth, which an effect may say.
            along = np.array([a.geometry.point_rotation[a.struck, :, axis] for a in own])
            found.append(self.found.by_moments(np.cross(along, system.force)))
        return np.stack(found)

    def by_hit_places(self) -> tuple[NamesOfMountings, ComplexArray]:
        """Places of hits: names (P, m, 3) and derivatives (3, P, m, 3, L), of a mounting's own."""
        of_point = [self.ordinary.hit_place_names(p.id) for p in self.ordinary.arm.points]
        at = (own.lines.hit_point[own.lines.hit] for own in self.assemblies)
        return [[of_point[point] for point in hits] for hits in at], self.by_hit_shifts()

    def by_places(self) -> tuple[NamesOfMountings, ComplexArray]:
        """Places of sensors: names (P, m, 3) and derivatives (3, P, m, 3, L), there alone."""
        of_point = [self.ordinary.place_names(p.id) for p in self.ordinary.arm.points]
        at = (own.lines.sensor_point for own in self.assemblies)
        return [[of_point[point] for point in sensors] for sensors in at], self.found.by_shift()

    def by_angles(self) -> Iterator[tuple[str, ComplexArray]]:
        """Joint angles, by which the encoders are off."""
        slopes = self.angle_slopes()
        names = [f"encoder {joint.name}" for joint in self.ordinary.arm.joints]
        return zip(names, by_slopes(self.found, slopes), strict=True)

    def angle_slopes(self) -> Slopes:
        """Return how the equations change with the angles."""
        return angle_slopes(self.assemblies, self.exact.whole, self.near)

    def motion_slopes(self, names: Sequence[str]) -> MotionSlopes:
        """Return how they change with what coordinates that give way move."""
        return motion_slopes(self.assemblies, self.exact.whole, names)

    def systems(self, assemblies: Sequence[Assembly]) -> System:
        """Return equations of the same postures."""
        return systems(assemblies)

    def by_terms(self) -> Iterator[tuple[str, ComplexArray]]:
        """What effects add linearly."""
        for name, terms in self.assemblies[0].terms_of.items():
            slopes = np.array([[v for *_, v in own.terms_of[name]] for own in self.assemblies])
            columns = [self.found.by_term(kind, i, j) for kind, i, j, _ in terms]
            yield name, _weighed_sum(columns, slopes.T)
        for name, rows in self.assemblies[0].stretches_of.items():
            of_all = [own.stretches_of[name] for own in self.assemblies]
            slopes = np.array([[v for *_, v in own] for own in of_all])
            columns = [
                self.found.by_stretch_of(kind, np.stack([own[at][1] for own in of_all]))
                for at, (kind, _, _) in enumerate(rows)
            ]
            yield name, _weighed_sum(columns, slopes.T)

    def by_turns(self) -> Iterator[tuple[str, ComplexArray]]:
        """What turns the stretch of an effect's spring or damper: r r' changes on both sides."""
        for name, turns in self.assemblies[0].turns_of.items():
            for at, (kind, _, _) in enumerate(turns):
                of_all = [own.turns_of[name][at] for own in self.assemblies]
                row, change = (np.stack([own[side] for own in of_all]) for side in (1, 2))
                if row.any() and change.any():
                    yield name, self.found.by_stretches(row, change, self.found.weight(kind))

    def by_motions(self) -> Iterator[tuple[str, ComplexArray]]:
        """What coordinates that give way move; nothing where they are locked.

        One on a spring, without a compliance, gives way.
        """
        system = self.exact.whole
        moves = {
            name: len(own)
            for name, own in self.assemblies[0].motion_of.items()
            if any((system.compliance[:, at] != 0.0).any() for at, _ in own)
        }
        if moves:
            columns = iter(by_motion(self.found, self.motion_slopes([*moves])))
            for name, n in moves.items():
                yield name, np.sum([next(columns) for _ in range(n)], axis=0)

    def by_sensor_mass(self) -> Iterator[tuple[str, ComplexArray]]:
        """The accelerometer's mass."""
        for name in self.assemblies[0].sensor_mass_of:
            yield name, self.found.by_sensor_mass()

    def by_laws(self) -> Iterator[tuple[str, ComplexArray]]:
        """Joints' own laws: what each of their parameters changes beside the linear model."""
        for instance in self.hypothesis.instances:
            laws = [instance.linear_law(own.lines) for own in self.assemblies]
            known = [law for law in laws if law is not None]
            if len(known) == len(laws):
                nothing = np.zeros_like(known[0].added)
                for name in dict.fromkeys(name for law in known for name in law.by):
                    of_each = [law.by.get(name, nothing) for law in known]
                    yield name, np.stack(of_each).astype(self.found.x.dtype)

    def by_differences(self, space: Space) -> Iterator[tuple[str, ComplexArray]]:
        """What is left of effects, by differences of the equations."""
        first = self.assemblies[0]
        known = {
            *first.compliance_of,
            *first.compliance_slopes,
            *first.loss_of,
            *first.loss_factor_of,
            *first.terms_of,
            *first.stretches_of,
            *first.inertia_of,
            *first.turns_of,
            *first.motion_of,
            *first.sensor_mass_of,
            *first.log_slopes,
            *(n for i in self.hypothesis.instances if i.linear_law(first.lines) for n in i.owned),
        }
        for instance in self.hypothesis.instances:
            for parameter in instance.parameters:
                is_idle = parameter.name in instance.shapes and self.values[instance.size] == 0.0
                if parameter.name in known or parameter.name not in space.index or is_idle:
                    continue
                step = _RELATIVE_STEP * parameter.std
                if self.values[parameter.name] + step > parameter.high:
                    step = -step
                changed = {**self.values, parameter.name: self.values[parameter.name] + step}
                other = self.systems([self.hypothesis.add_to(own, changed) for own in self.plain])
                before, after = (of.among(self.exact.moving) for of in (self.exact.whole, other))
                found = by_change(self.found, Change.between(before, after, step))
                decay = (after.decay_rad_s - before.decay_rad_s) / step
                if decay.any():
                    by_line = by_decay(self.found)
                    found += decay.astype(found.real.dtype)[:, None, None, None] * by_line
                yield parameter.name, found


def _weighed_sum(columns: Sequence[ComplexArray], weights: Array) -> ComplexArray:
    """Sum of columns (P, m, 3, L), each with a weight (P,) of every posture."""
    return np.asarray(
        sum(c * w[:, None, None, None] for c, w in zip(columns, as_single(weights), strict=True))
    )


def _inertia_changes(
    ordinary: Ordinary, link: int, names: tuple[str, ...], values: Mapping[str, float]
) -> Array:
    """Change (10, 6, 6) of a link's spatial inertia by each parameter."""
    z = np.array([values[name] for name in names])
    beside = np.concatenate([z[None], z + _INERTIA_STEP * np.eye(len(names))])
    inertias, _ = ordinary.link_inertias([link] * len(beside), beside)
    return np.asarray((inertias[1:] - inertias[0]) / _INERTIA_STEP)
