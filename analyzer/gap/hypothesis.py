"""A hypothesis: the ordinary model, and the effects that are said to be there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from analyzer.arm.superset import Superset
from analyzer.gap.assembly import Assembly
from analyzer.gap.effects.effect import Instance
from analyzer.gap.geometry import GeometryNear, PostureGeometry
from analyzer.gap.lines import PostureLines
from analyzer.gap.ordinary import Ordinary, across
from analyzer.gap.response import Change, Response, respond
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
        return respond(assembly.system(), lines, sensor_mass_kg=_sensor_mass(assembly))

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
        y, dy, _, _ = self._derivatives(hypothesis, lines, space, values)
        return y, dy

    def interface_columns(
        self,
        hypothesis: Hypothesis,
        lines: PostureLines,
        space: Space,
        values: Mapping[str, float],
        names: Sequence[str],
        pairs: Sequence[tuple[int, int]],
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Derivatives, and those by the compliance matrix of some locked coordinates.

        Returns
        -------
        y : (m, 3, L), dy : (n_parameters, m, 3, L)
        columns : (n_pairs, m, 3, L)
            By an element a, b of the compliance matrix of the coordinates `names`, both
            triangles' mean.
        """
        y, dy, assembly, found = self._derivatives(hypothesis, lines, space, values)
        left, right = found.through_compliances([assembly.compliance_of[name] for name in names])
        columns = [
            0.5 * (left[a] * right[b][:, None] + left[b] * right[a][:, None]) for a, b in pairs
        ]
        return y, dy, np.stack(columns)

    def _derivatives(
        self,
        hypothesis: Hypothesis,
        lines: PostureLines,
        space: Space,
        values: Mapping[str, float],
    ) -> tuple[ComplexArray, ComplexArray, Assembly, Response]:
        ordinary = hypothesis.ordinary
        offset = ordinary.encoder(values)
        geometry = self._near.at(offset)
        assembly = _assembled(hypothesis, geometry, lines, values)
        system = assembly.system()
        found = respond(system, lines, sensor_mass_kg=_sensor_mass(assembly))
        y = found.values
        dy = np.zeros((len(space), *y.shape), dtype=np.complex128)

        def put(name: str, derivative: ComplexArray | float) -> None:
            if name in space.index:
                dy[space.index[name]] = derivative * space.std[space.index[name]]

        # Joints; k enters with its hysteretic part.
        n = system.mass.shape[0]
        by_common_loss = np.zeros_like(y)
        for i in ordinary.elastic:
            name = ordinary.arm.joints[i].name
            row = np.zeros(n)
            row[assembly.names[name]] = 1.0
            if name in assembly.stretched_by:
                row[assembly.stretched_by[name]] = -1.0
            k = float(np.exp(values[f"ln k {name}"]))
            by_stiffness = k * found.by_stretch(row, 1.0)
            put(f"ln k {name}", (1.0 + 1j * values["loss"]) * by_stiffness)
            by_common_loss = by_common_loss + 1j * by_stiffness
            c = float(np.exp(values[f"ln c {name}"]))
            put(f"ln c {name}", c * found.by_stretch(row, lines.s_rad_s))
        put("loss", by_common_loss)
        compliances = assembly.compliance_of
        rows = found.by_compliances(list(compliances.values()))
        for name, row in zip(compliances, rows, strict=True):
            put(name, row)
        of_coordinate = {at: i for i, at in enumerate(compliances.values())}
        for name, coordinates in assembly.loss_of.items():
            by_loss = np.zeros_like(y)
            for at in coordinates:
                slower = -system.compliance[at] * lines.s_rad_s
                slower = slower / (1.0 + system.compliance_loss_s[at] * lines.s_rad_s)
                by_loss = by_loss + rows[of_coordinate[at]] * slower
            put(name, by_loss)
        for link in range(len(ordinary.arm.joints)):
            names = ordinary.inertia_names(link)
            rows = found.by_link_inertia(link, _inertia_changes(ordinary, link, names, values))
            for name, row in zip(names, rows, strict=True):
                put(name, row)
        for axis, letter in enumerate("xyz"):
            only_axis = np.zeros_like(y)
            only_axis[:, axis] = y[:, axis]
            put(f"ln gain {letter}", only_axis)
        put("ln hammer", -y)
        put("delay", -lines.s_rad_s * y)
        if len(lines.hit_point) == 1:
            sides = across(lines.hit_direction[0])
            for side, letter in enumerate("ab"):
                put(f"aim {letter} {lines.name}", found.by_force(0, sides[:, side]))
        for i, joint in enumerate(ordinary.arm.joints):
            beside, step = self._near.beside(offset, i)
            moved = replace(assembly, geometry=beside).system()
            put(f"encoder {joint.name}", found.by_change(Change.between(system, moved, step)))
        for instance in hypothesis.instances:
            for parameter in instance.parameters:
                if parameter.name in assembly.compliance_of or parameter.name in assembly.loss_of:
                    continue
                step = _RELATIVE_STEP * parameter.std
                if values[parameter.name] + step > parameter.high:
                    step = -step
                changed = dict(values)
                changed[parameter.name] += step
                other = _assembled(hypothesis, geometry, lines, changed).system()
                put(parameter.name, found.by_change(Change.between(system, other, step)))
        return y, dy, assembly, found


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


def _sensor_mass(assembly: Assembly) -> float:
    own = assembly.sensor_mass_kg
    return assembly.lines.sensor_mass_kg if own is None else own


def _inertia_changes(
    ordinary: Ordinary, link: int, names: tuple[str, ...], values: Mapping[str, float]
) -> Array:
    """Change (10, 6, 6) of a link's spatial inertia by each parameter."""
    z = np.array([values[name] for name in names])
    start, _ = ordinary.link_inertia(link, z)
    changes = []
    for i in range(len(names)):
        moved = z.copy()
        moved[i] += _INERTIA_STEP
        changes.append((ordinary.link_inertia(link, moved)[0] - start) / _INERTIA_STEP)
    return np.stack(changes)
