"""Predictions in postures, and their derivatives by every parameter.

Postures whose lines are alike are solved together: a posture alone has too few lines to keep the
arithmetic busy.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
import numpy.typing as npt

from analyzer.arm.superset import Superset
from analyzer.gap.assembly import BASE, Assembly, System
from analyzer.gap.change import Change, by_change
from analyzer.gap.geometry import GeometryNear, GeometrySlopes, PostureGeometry
from analyzer.gap.hypothesis import Hypothesis
from analyzer.gap.lines import PostureLines
from analyzer.gap.moved_otherwise import by_motion, by_slopes
from analyzer.gap.ordinary import Ordinary, across
from analyzer.gap.response import Response, as_single, hysteresis, respond
from analyzer.gap.space import Space
from analyzer.gap.systems import angle_slopes, motion_slopes, stacked_slopes, systems

__all__ = ["PosedModel", "Postures"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_INERTIA_STEP = 1e-6
_RELATIVE_STEP = 1e-3  # of a parameter's prior deviation


class PosedModel:
    """An arm in one posture, with the geometry of the last angles at hand."""

    def __init__(self, superset: Superset, joints_rad: Array) -> None:
        self._near = GeometryNear(superset, joints_rad)

    def geometry(self, ordinary: Ordinary, values: Mapping[str, float]) -> PostureGeometry:
        """Geometry at the angles read and the encoders' offsets."""
        return self._near.at(ordinary.encoder(values))

    def slopes(self) -> GeometrySlopes:
        """Return how the geometry last asked for changes with the angles."""
        return self._near.slopes()

    def system(
        self, hypothesis: Hypothesis, lines: PostureLines, values: Mapping[str, float]
    ) -> System:
        """Return the posture's equations."""
        ordinary = hypothesis.ordinary
        geometry = self.geometry(ordinary, values)
        plain = ordinary.assemble(geometry, lines, values, ordinary.bodies(values))
        return systems([hypothesis.add_to(plain, values)]).alone(0)

    def values(
        self, hypothesis: Hypothesis, lines: PostureLines, values: Mapping[str, float]
    ) -> ComplexArray:
        """Predict the posture's FRFs: (m, 3, L)."""
        return np.asarray(Postures([self], [lines]).response(hypothesis, values).values[0])

    def derivatives(
        self,
        hypothesis: Hypothesis,
        lines: PostureLines,
        space: Space,
        values: Mapping[str, float],
    ) -> tuple[ComplexArray, ComplexArray]:
        """FRFs (m, 3, L) and derivatives (n_parameters, m, 3, L), as `Postures.derivatives`."""
        y, dy = Postures([self], [lines]).derivatives(hypothesis, space, values)
        return y[0], dy[:, 0]


class Postures:
    """P postures with lines alike: as many mountings, hits and lines."""

    def __init__(self, models: Sequence[PosedModel], lines: Sequence[PostureLines]) -> None:
        self._models, self.lines = tuple(models), tuple(lines)
        self._s_rad_s = np.stack([own.s_rad_s for own in lines])
        self._hit = np.stack([own.hit for own in lines])
        self._own_slopes: list[GeometrySlopes] = []
        self._last: _Solved | None = None

    @staticmethod
    def likeness(lines: PostureLines) -> tuple[object, ...]:
        """Return what postures that are solved together have in common."""
        return lines.values.shape, len(lines.hit_point), lines.brakes

    def response(self, hypothesis: Hypothesis, values: Mapping[str, float]) -> Response:
        """Predict the postures' FRFs."""
        return self._solved(hypothesis, values).exact

    def derivatives(
        self, hypothesis: Hypothesis, space: Space, values: Mapping[str, float]
    ) -> tuple[ComplexArray, ComplexArray]:
        """Predict FRFs and their derivatives by a prior deviation of each parameter.

        Returns
        -------
        y : (P, m, 3, L) complex128
        dy : (n_parameters, P, m, 3, L) complex64, or complex128 far from anything sensible
            Rows of parameters that do not act here are zero.
        """
        posed = self._solved(hypothesis, values)
        y = posed.exact.values
        std = space.std.astype(posed.found.x.real.dtype)
        dy = np.empty((len(space), *y.shape), dtype=posed.found.x.dtype)
        idle = set(range(len(space)))
        for name, derivative in chain(
            posed.by_joints(),
            posed.by_compliances(),
            posed.by_inertias(),
            posed.by_measurement(),
            posed.by_angles(self._slopes()),
            posed.by_terms(),
            posed.by_turns(),
            posed.by_motions(),
            posed.by_sensor_mass(),
            posed.by_differences(space, self._s_rad_s),
        ):
            if name not in space.index:
                continue
            i = space.index[name]
            if i in idle:
                np.multiply(derivative, std[i], out=dy[i], casting="same_kind")
                idle.remove(i)
            else:
                dy[i] += derivative * std[i]
        dy[list(idle)] = 0.0
        for p, name, own in posed.by_aims():
            if name in space.index:
                dy[space.index[name], p] += own * std[space.index[name]]
        return y, dy

    def interface_columns(
        self,
        hypothesis: Hypothesis,
        values: Mapping[str, float],
        names: Sequence[str],
        pairs: Sequence[tuple[int, int]],
    ) -> ComplexArray:
        """Derivatives (n_pairs, P, m, 3, L) by the compliance matrix of some locked coordinates.

        Of an element a, b of that of the coordinates `names`: both triangles' mean.
        """
        solved = self._solved(hypothesis, values)
        found, assemblies = solved.found, solved.assemblies
        left, right = found.through_compliances(
            [assemblies[0].compliance_of[name][0][0] for name in names]
        )
        right = right[:, :, :, None]
        return np.stack([0.5 * (left[a] * right[b] + left[b] * right[a]) for a, b in pairs])

    def damping_columns(
        self,
        hypothesis: Hypothesis,
        values: Mapping[str, float],
        pairs: Sequence[tuple[str, str]],
    ) -> tuple[ComplexArray, list[PostureGeometry]]:
        """Derivatives (n_pairs, P, m, 3, L) by a damping between two joints; geometries.

        Of an element of C of two named joints: both triangles' mean.
        """
        solved = self._solved(hypothesis, values)
        found, assemblies = solved.found, solved.assemblies
        names = assemblies[0].names
        at = [(names[a], names[b]) for a, b in pairs]
        columns = [
            0.5 * (found.by_term("damping", i, j) + found.by_term("damping", j, i)) for i, j in at
        ]
        return np.stack(columns), [assembly.geometry for assembly in assemblies]

    def _assemblies(
        self, hypothesis: Hypothesis, values: Mapping[str, float]
    ) -> tuple[list[Assembly], list[Assembly]]:
        """Each posture's equations, without effects and with them."""
        ordinary = hypothesis.ordinary
        bodies = ordinary.bodies(values)
        plain = [
            ordinary.assemble(model.geometry(ordinary, values), lines, values, bodies)
            for model, lines in zip(self._models, self.lines, strict=True)
        ]
        return plain, [hypothesis.add_to(own, values) for own in plain]

    def _solved(self, hypothesis: Hypothesis, values: Mapping[str, float]) -> _Solved:
        """The last solution is kept: a step is tried first, its derivatives asked for after."""
        last = self._last
        if last is None or last.hypothesis is not hypothesis or last.values != values:
            plain, assemblies = self._assemblies(hypothesis, values)
            found = respond(systems(assemblies), self._s_rad_s, self._hit)
            last = self._last = _Solved(hypothesis, plain, assemblies, found, dict(values))
        return last

    def _slopes(self) -> GeometrySlopes:
        """Stacked, anew only where a geometry's centre has moved."""
        own = [model.slopes() for model in self._models]
        if any(a is not b for a, b in zip(own, self._own_slopes, strict=False)) or not (
            self._own_slopes
        ):
            self._own_slopes, self._stacked = own, stacked_slopes(own)
        return self._stacked


@dataclass(frozen=True, slots=True)
class _Solved:
    """Solved postures, and their derivatives (P, m, 3, L) by name."""

    hypothesis: Hypothesis
    plain: Sequence[Assembly]  # without effects
    assemblies: Sequence[Assembly]
    exact: Response
    values: Mapping[str, float]

    @property
    def found(self) -> Response:
        """Return what derivatives are made of."""
        return self.exact.for_derivatives

    @property
    def ordinary(self) -> Ordinary:
        """Return the ordinary model."""
        return self.hypothesis.ordinary

    def by_joints(self) -> Iterator[tuple[str, ComplexArray]]:
        """Stiffness with its hysteretic part, damping, and the common loss."""
        s = self.found.s_rad_s
        loss, turn = self.values["loss"], hysteresis(s)[:, None, None, :]
        by_loss: ComplexArray = np.zeros((), dtype=np.complex128)
        by_spring: dict[str, tuple[ComplexArray, ComplexArray]] = {}
        for i in self.ordinary.elastic:
            name = self.ordinary.arm.joints[i].name
            row = np.stack([own.joint_row(name) for own in self.assemblies])
            factors = np.array([own.factors.get(name, (1.0, 1.0)) for own in self.assemblies])
            k, c = (float(np.exp(self.values[f"ln {what} {name}"])) for what in "kc")
            by_stiffness = self.found.by_stretch(row, k * factors[:, :1])
            by_spring[name] = (
                (1.0 + loss * turn) * by_stiffness,
                self.found.by_stretch(row, c * factors[:, 1:] * s),
            )
            yield f"ln k {name}", by_spring[name][0]
            yield f"ln c {name}", by_spring[name][1]
            by_loss = by_loss + turn * by_stiffness
        for parameter, (name, _, _) in self.assemblies[0].log_slopes.items():
            slopes = np.array([own.log_slopes[parameter][1:] for own in self.assemblies])
            by_k, by_c = as_single(slopes).T[:, :, None, None, None]
            yield parameter, by_k * by_spring[name][0] + by_c * by_spring[name][1]
        yield "loss", by_loss

    def by_compliances(self) -> Iterator[tuple[str, ComplexArray]]:
        """Compliances and their losses."""
        s, system = self.found.s_rad_s, self.found.system
        compliances = self.assemblies[0].compliance_of
        every = [at for parts in compliances.values() for at, _ in parts]
        row_of = dict(zip(every, self.found.by_compliances(every), strict=True))
        for name, parts in compliances.items():
            weights = np.array(
                [[part for _, part in own.compliance_of[name]] for own in self.assemblies]
            )
            yield name, _weighed_sum([row_of[at] for at, _ in parts], weights.T)
        for name, coordinates in self.assemblies[0].loss_of.items():
            slower = [
                -system.compliance[:, at, None]
                * s
                / (1.0 + system.compliance_loss_s[:, at, None] * s)
                for at in coordinates
            ]
            yield (
                name,
                np.sum(
                    [
                        row_of[at] * w[:, None, None, :]
                        for at, w in zip(coordinates, slower, strict=True)
                    ],
                    axis=0,
                ),
            )

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
        """Gains and delay."""
        found = self.found
        y = found.values
        for axis, letter in enumerate("xyz"):
            column = found.system.mix[..., axis]  # (P, m, 3) of the recorded channels
            true = found.true_axes[:, :, axis]  # (P, m, L)
            yield f"ln gain {letter}", column[..., None] * true[:, :, None]
        yield "ln hammer", -y
        yield "delay", -found.s_rad_s[:, None, None, :] * y

    def by_aims(self) -> Iterator[tuple[int, str, ComplexArray]]:
        """Aim of each posture's hits: derivatives (m, 3, L) there, elsewhere they do nothing."""
        found = self.found
        if found.system.hit.shape[1] == 1:
            sides = np.stack(
                [own.hit_turn @ across(own.lines.hit_direction[0]) for own in self.assemblies]
            )
            for side, letter in enumerate("ab"):
                by_aim = found.by_force(0, sides[..., side])
                for p, own in enumerate(self.assemblies):
                    yield p, f"aim {letter} {own.lines.name}", by_aim[p]

    def by_angles(self, near: GeometrySlopes) -> Iterator[tuple[str, ComplexArray]]:
        """Joint angles, by which the encoders are off."""
        slopes = angle_slopes(self.assemblies, self.exact.system, near)
        names = [f"encoder {joint.name}" for joint in self.ordinary.arm.joints]
        return zip(names, by_slopes(self.found, slopes), strict=True)

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
        for name, (kind, _, _) in self.assemblies[0].turns_of.items():
            of_all = [own.turns_of[name] for own in self.assemblies]
            row, change = (np.stack([own[side] for own in of_all]) for side in (1, 2))
            if change.any():
                yield name, self.found.by_stretches(row, change, self.found.weight(kind))

    def by_motions(self) -> Iterator[tuple[str, ComplexArray]]:
        """What coordinates that give way move; nothing where they are locked."""
        system = self.found.system
        moves = {
            name: len(own)
            for name, own in self.assemblies[0].motion_of.items()
            if any(system.compliance[:, at].any() for at, _ in own)
        }
        if moves:
            columns = iter(by_motion(self.found, motion_slopes(self.assemblies, system, [*moves])))
            for name, n in moves.items():
                yield name, np.sum([next(columns) for _ in range(n)], axis=0)

    def by_sensor_mass(self) -> Iterator[tuple[str, ComplexArray]]:
        """The accelerometer's mass."""
        for name in self.assemblies[0].sensor_mass_of:
            yield name, self.found.by_sensor_mass()

    def by_differences(
        self, space: Space, s_rad_s: ComplexArray
    ) -> Iterator[tuple[str, ComplexArray]]:
        """What is left of effects, by differences of the equations."""
        first = self.assemblies[0]
        known = {
            *first.compliance_of,
            *first.loss_of,
            *first.terms_of,
            *first.stretches_of,
            *first.inertia_of,
            *first.turns_of,
            *first.motion_of,
            *first.sensor_mass_of,
            *first.log_slopes,
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
                other = systems([self.hypothesis.add_to(own, changed) for own in self.plain])
                if not np.array_equal(other.decay_rad_s, self.exact.system.decay_rad_s):
                    there = respond(other, s_rad_s, self.exact.hit)
                    yield parameter.name, (there.values - self.exact.values) / step
                    continue
                change = Change.between(self.exact.system, other, step)
                yield parameter.name, by_change(self.exact, change)


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
