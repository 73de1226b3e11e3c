"""A hypothesis: the ordinary model, and the effects that are said to be there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
import numpy.typing as npt

from analyzer.arm.superset import Superset
from analyzer.gap.assembly import Assembly, System
from analyzer.gap.effects.effect import Instance
from analyzer.gap.geometry import GeometryNear, PostureGeometry
from analyzer.gap.lines import PostureLines
from analyzer.gap.ordinary import Ordinary, across
from analyzer.gap.response import Change, Response, hysteresis, respond
from analyzer.gap.slopes import angle_slopes
from analyzer.gap.space import Space

__all__ = ["Hypothesis", "PosedModel"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_INERTIA_STEP = 1e-6
_RELATIVE_STEP = 1e-3  # of a parameter's prior deviation


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """Instances of effects on top of the ordinary model; none is the null."""

    ordinary: Ordinary
    instances: tuple[Instance, ...] = ()

    @property
    def name(self) -> str:
        """Return what is said to be there, in words."""
        return " + ".join(instance.title for instance in self.instances) or "nothing missing"

    def space(self) -> Space:
        """Return all parameters."""
        space = Space(self.ordinary.parameters())
        for instance in self.instances:
            space = space.with_changes(
                {p.name: p for p in instance.relaxed(space)}, instance.parameters
            )
        return space


class PosedModel:
    """Predictions in one posture, with the geometry of the last angles at hand."""

    def __init__(self, superset: Superset, joints_rad: Array) -> None:
        self._near = GeometryNear(superset, joints_rad)

    def response(
        self, hypothesis: Hypothesis, lines: PostureLines, values: Mapping[str, float]
    ) -> Response:
        """Predict a posture's FRFs."""
        geometry = self._near.at(hypothesis.ordinary.encoder(values))
        assembly = _assembled(hypothesis, geometry, lines, values)
        return respond(assembly.system(), lines)

    def derivatives(
        self,
        hypothesis: Hypothesis,
        lines: PostureLines,
        space: Space,
        values: Mapping[str, float],
    ) -> tuple[ComplexArray, ComplexArray]:
        """Predict a posture's FRFs and their derivatives by a prior deviation of each parameter.

        Returns
        -------
        y : (m, 3, L) complex128
        dy : (n_parameters, m, 3, L) complex128
            Rows of parameters that do not act here are zero.
        """
        geometry = self._near.at(hypothesis.ordinary.encoder(values))
        assembly = _assembled(hypothesis, geometry, lines, values)
        system = assembly.system()
        found = respond(system, lines)
        y = found.values
        dy = np.zeros((len(space), *y.shape), dtype=np.complex128)
        posed = _Posed(hypothesis.ordinary, assembly, system, found, values)
        for name, derivative in chain(
            posed.by_joints(),
            posed.by_compliances(),
            posed.by_inertias(),
            posed.by_measurement(),
            self._by_angles(posed),
            _by_effects(hypothesis, geometry, posed),
        ):
            if name in space.index:
                dy[space.index[name]] += derivative * space.std[space.index[name]]
        return y, dy

    def interface_columns(
        self,
        hypothesis: Hypothesis,
        lines: PostureLines,
        values: Mapping[str, float],
        names: Sequence[str],
        pairs: Sequence[tuple[int, int]],
    ) -> ComplexArray:
        """Derivatives (n_pairs, m, 3, L) by the compliance matrix of some locked coordinates.

        Of an element a, b of that of the coordinates `names`: both triangles' mean.
        """
        geometry = self._near.at(hypothesis.ordinary.encoder(values))
        assembly = _assembled(hypothesis, geometry, lines, values)
        found = respond(assembly.system(), lines)
        left, right = found.through_compliances(
            [assembly.compliance_of[name][0][0] for name in names]
        )
        return np.stack(
            [0.5 * (left[a] * right[b][:, None] + left[b] * right[a][:, None]) for a, b in pairs]
        )

    def damping_columns(
        self,
        hypothesis: Hypothesis,
        lines: PostureLines,
        values: Mapping[str, float],
        pairs: Sequence[tuple[str, str]],
    ) -> tuple[ComplexArray, PostureGeometry]:
        """Derivatives (n_pairs, m, 3, L) by a damping between two joints; posture's geometry.

        Of an element of C of two named joints: both triangles' mean.
        """
        geometry = self._near.at(hypothesis.ordinary.encoder(values))
        assembly = _assembled(hypothesis, geometry, lines, values)
        found = respond(assembly.system(), lines)
        at = [(assembly.names[a], assembly.names[b]) for a, b in pairs]
        columns = [
            0.5 * (found.by_term("damping", i, j) + found.by_term("damping", j, i)) for i, j in at
        ]
        return np.stack(columns), geometry

    def _by_angles(self, posed: _Posed) -> Iterator[tuple[str, ComplexArray]]:
        slopes = angle_slopes(posed.assembly, posed.system, self._near.slopes())
        names = [f"encoder {joint.name}" for joint in posed.ordinary.arm.joints]
        return zip(names, posed.found.by_slopes(slopes), strict=True)


@dataclass(frozen=True, slots=True)
class _Posed:
    """A solved posture, and its derivatives by the parameters every hypothesis has."""

    ordinary: Ordinary
    assembly: Assembly
    system: System
    found: Response
    values: Mapping[str, float]

    def by_joints(self) -> Iterator[tuple[str, ComplexArray]]:
        """Stiffness with its hysteretic part, damping, and the common loss."""
        s = self.found.lines.s_rad_s
        loss, turn = self.values["loss"], hysteresis(s)
        by_loss: ComplexArray = np.zeros((), dtype=np.complex128)
        by_spring: dict[str, tuple[ComplexArray, ComplexArray]] = {}
        for i in self.ordinary.elastic:
            name = self.ordinary.arm.joints[i].name
            row = self.assembly.joint_row(name)
            k, c = (float(np.exp(self.values[f"ln {what} {name}"])) for what in "kc")
            more_k, more_c = self.assembly.factors.get(name, (1.0, 1.0))
            by_stiffness = k * more_k * self.found.by_stretch(row, 1.0)
            by_spring[name] = (
                (1.0 + loss * turn) * by_stiffness,
                c * more_c * self.found.by_stretch(row, s),
            )
            yield f"ln k {name}", by_spring[name][0]
            yield f"ln c {name}", by_spring[name][1]
            by_loss = by_loss + turn * by_stiffness
        for parameter, (name, by_k, by_c) in self.assembly.log_slopes.items():
            yield parameter, by_k * by_spring[name][0] + by_c * by_spring[name][1]
        yield "loss", by_loss

    def by_compliances(self) -> Iterator[tuple[str, ComplexArray]]:
        """Compliances and their losses."""
        s, system = self.found.lines.s_rad_s, self.system
        compliances = self.assembly.compliance_of
        every = [at for parts in compliances.values() for at, _ in parts]
        row_of = dict(zip(every, self.found.by_compliances(every), strict=True))
        for name, parts in compliances.items():
            yield name, np.sum([row_of[at] * part for at, part in parts], axis=0)
        for name, coordinates in self.assembly.loss_of.items():
            slower = [
                -system.compliance[at] * s / (1.0 + system.compliance_loss_s[at] * s)
                for at in coordinates
            ]
            yield (
                name,
                np.sum([row_of[at] * w for at, w in zip(coordinates, slower, strict=True)], 0),
            )

    def by_inertias(self) -> Iterator[tuple[str, ComplexArray]]:
        """Masses, centres and tensors of the links."""
        for link in range(len(self.ordinary.arm.joints)):
            names = self.ordinary.inertia_names(link)
            changes = _inertia_changes(self.ordinary, link, names, self.values)
            yield from zip(names, self.found.by_link_inertia(link, changes), strict=True)

    def by_measurement(self) -> Iterator[tuple[str, ComplexArray]]:
        """Gains, delay and aim."""
        found, lines = self.found, self.found.lines
        y = found.values
        for axis, letter in enumerate("xyz"):
            column = self.system.mix[:, :, axis]  # of the recorded channels
            yield f"ln gain {letter}", column[..., None] * found.true_axes[:, :, axis].T[:, None]
        yield "ln hammer", -y
        yield "delay", -lines.s_rad_s * y
        if len(lines.hit_point) == 1:
            sides = across(lines.hit_direction[0])
            for side, letter in enumerate("ab"):
                yield f"aim {letter} {lines.name}", found.by_force(0, sides[:, side])


def _by_effects(
    hypothesis: Hypothesis, geometry: PostureGeometry, posed: _Posed
) -> Iterator[tuple[str, ComplexArray]]:
    """What effects bring beside compliances, by differences of the equations."""
    assembly, found, lines = posed.assembly, posed.found, posed.assembly.lines
    for name, terms in assembly.terms_of.items():
        yield name, np.sum([v * found.by_term(kind, i, j) for kind, i, j, v in terms], axis=0)
    for name, rows in assembly.stretches_of.items():
        yield name, np.sum([v * found.by_stretch_of(kind, row) for kind, row, v in rows], axis=0)
    known = {
        *assembly.compliance_of,
        *assembly.loss_of,
        *assembly.terms_of,
        *assembly.stretches_of,
        *assembly.log_slopes,
    }
    for instance in hypothesis.instances:
        for parameter in instance.parameters:
            is_idle = parameter.name in instance.shapes and posed.values[instance.size] == 0.0
            if parameter.name in known or is_idle:
                continue
            step = _RELATIVE_STEP * parameter.std
            if posed.values[parameter.name] + step > parameter.high:
                step = -step
            changed = {**posed.values, parameter.name: posed.values[parameter.name] + step}
            other = _assembled(hypothesis, geometry, lines, changed).system()
            if other.decay_rad_s != posed.system.decay_rad_s:
                there = respond(other, lines)
                yield parameter.name, (there.values - posed.found.values) / step
                continue
            yield parameter.name, posed.found.by_change(Change.between(posed.system, other, step))


def _assembled(
    hypothesis: Hypothesis,
    geometry: PostureGeometry,
    lines: PostureLines,
    values: Mapping[str, float],
) -> Assembly:
    assembly = hypothesis.ordinary.assemble(geometry, lines, values)
    for instance in hypothesis.instances:
        instance.add(assembly, values)
    return assembly


def _inertia_changes(
    ordinary: Ordinary, link: int, names: tuple[str, ...], values: Mapping[str, float]
) -> Array:
    """Change (10, 6, 6) of a link's spatial inertia by each parameter."""
    z = np.array([values[name] for name in names])
    beside = np.concatenate([z[None], z + _INERTIA_STEP * np.eye(len(names))])
    inertias, _ = ordinary.link_inertias([link] * len(beside), beside)
    return np.asarray((inertias[1:] - inertias[0]) / _INERTIA_STEP)
