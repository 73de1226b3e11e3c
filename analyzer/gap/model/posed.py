"""Predictions in postures, and their derivatives by every parameter.

Postures whose lines are alike are solved together: a posture alone has too few lines to keep the
arithmetic busy.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.columns import Columns
from armodal.analyzer.gap.model.derivatives import Solved
from armodal.analyzer.gap.model.geometry import GeometryNear, GeometrySlopes, PostureGeometry
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.joint_turns import SolvedTurns, holding_back, turned_systems
from armodal.analyzer.gap.model.line_arrays import as_single
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.response import Response, respond
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.gap.model.system import System
from armodal.analyzer.gap.model.systems import stacked_slopes, systems

__all__ = ["PosedModel", "Postures"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]
Indices = npt.NDArray[np.int64]

_TOGETHER = 320  # lines of postures solved together: more outgrow the processor's cache


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
        (plain,) = ordinary.assemblies([geometry], [lines], values)
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
    """P postures with lines alike: as many mountings, hits and lines.

    `single`: derivatives in single precision where it is wide enough.
    """

    def __init__(
        self,
        models: Sequence[PosedModel],
        lines: Sequence[PostureLines],
        *,
        single: bool = True,
    ) -> None:
        self._models, self.lines, self._single = tuple(models), tuple(lines), single
        self._s_rad_s = np.stack([own.s_rad_s for own in lines])
        self._hit = np.stack([own.hit for own in lines])
        self._own_slopes: list[GeometrySlopes] = []
        self._last: Solved | None = None
        self._last_columns: tuple[Solved, Space, Columns] | None = None

    @classmethod
    def in_groups(
        cls, models: Sequence[PosedModel], lines: Sequence[PostureLines], used: Sequence[int]
    ) -> list[tuple[list[int], Postures]]:
        """Return the postures used, by their numbers, in groups that are solved together."""
        alike: dict[tuple[object, ...], list[int]] = {}
        for p in used:
            own = lines[p]
            likeness = own.values.shape, len(own.hit_point), own.brakes
            alike.setdefault(likeness, []).append(p)
        groups = []
        for of_a_kind in alike.values():
            most = max(_TOGETHER // lines[of_a_kind[0]].s_rad_s.size, 1)
            groups += [of_a_kind[i : i + most] for i in range(0, len(of_a_kind), most)]
        return [(own, cls([models[p] for p in own], [lines[p] for p in own])) for own in groups]

    def response(self, hypothesis: Hypothesis, values: Mapping[str, float]) -> Response:
        """Predict the postures' FRFs."""
        return self._solved(hypothesis, values).exact

    def assembled(self, hypothesis: Hypothesis, values: Mapping[str, float]) -> list[Assembly]:
        """Return each posture's equations."""
        return self._assemblies(hypothesis, values)[1]

    def by_shift(self, hypothesis: Hypothesis, values: Mapping[str, float]) -> ComplexArray:
        """Derivatives (3, P, m, 3, L) by a shift of what goes round, along a sensor's axes there.

        Of the sensor, or of the hits where the hammer goes from point to point.
        """
        solved = self._solved(hypothesis, values)
        return solved.by_hit_shifts() if self.lines[0].hammer_roves else solved.found.by_shift()

    def derivatives(
        self, hypothesis: Hypothesis, space: Space, values: Mapping[str, float]
    ) -> tuple[ComplexArray, ComplexArray]:
        """Predict FRFs and their derivatives by a prior deviation of each parameter.

        Returns
        -------
        y : (P, m, 3, L) complex128
        dy : (n_parameters, P, m, 3, L) complex64 if single precision is wide enough, or complex128
            Rows of parameters that do not act here are zero.
        """
        y, columns = self.columns(hypothesis, space, values)
        return y, columns.whole()

    def columns(
        self, hypothesis: Hypothesis, space: Space, values: Mapping[str, float]
    ) -> tuple[ComplexArray, Columns]:
        """Predict FRFs (P, m, 3, L) and their derivatives, as `derivatives`.

        Those of the last point are kept: several looks begin where a fit ended.
        """
        posed = self._solved(hypothesis, values)
        last = self._last_columns
        if last is None or last[0] is not posed or last[1].parameters != space.parameters:
            last = self._last_columns = posed, space, self._columns(posed, space)
        return posed.exact.values, last[2]

    def derivatives_holding_back(
        self,
        hypothesis: Hypothesis,
        space: Space,
        values: Mapping[str, float],
        rows: Array,
        torque: ComplexArray,
    ) -> ComplexArray:
        """Derivatives, as `derivatives`, while a torque is held back along rows (P, N).

        `torque` (P, m, L): per unit force of each mounting's hit; it stays.
        """
        posed = self._solved(hypothesis, values)
        under = replace(posed, exact=holding_back(posed.exact, rows, torque))
        return self._columns(under, space).whole()

    def turn_derivatives(
        self,
        hypothesis: Hypothesis,
        space: Space,
        values: Mapping[str, float],
        rows: Array,
        s_rad_s: ComplexArray,
        torque: ComplexArray,
    ) -> ComplexArray:
        """Derivatives (n_parameters, P, m, L) of stretches along rows (P, N), rad/N.

        By a prior deviation of each parameter, on lines (P, L), while a torque (P, m, L) per unit
        force of each mounting's hit is held back there, which stays.
        """
        plain, assemblies = self._assemblies(hypothesis, values)
        system = turned_systems(assemblies, rows, self._hit.shape[1])
        found = holding_back(respond(system, s_rad_s, self._hit), rows, torque)
        posed = SolvedTurns(
            hypothesis, plain, assemblies, found, dict(values), self._slopes(), self._single, rows
        )
        shape = (len(space), *found.true_axes.shape[:2], found.true_axes.shape[3])
        every = np.zeros(shape, dtype=posed.found.x.dtype)
        for name, derivative in chain(posed.by_equations(), posed.by_differences(space)):
            if name in space.index:
                every[space.index[name]] += derivative[:, :, 0]
        for p, name, own in posed.by_hit_directions():
            if name in space.index:
                every[space.index[name], p] += own[:, 0]
        of_mountings = np.indices(every.shape[1:3])
        for at, own in zip(*_of_hits(posed, space), strict=True):
            every[at, *of_mountings] += own[:, :, 0]
        return np.asarray(every * as_single(space.std)[:, None, None, None])

    def _columns(self, posed: Solved, space: Space) -> Columns:
        y = posed.exact.values
        std = space.std.astype(posed.found.x.real.dtype)
        places, of_hits = _of_sensors(posed, space), _of_hits(posed, space)
        own_rows = np.concatenate([places[0], of_hits[0]])
        shifts = np.concatenate([places[1], of_hits[1]])
        rows = np.setdiff1d(np.arange(len(space)), own_rows)
        shared = np.empty((len(rows), *y.shape), dtype=posed.found.x.dtype)
        among = set(rows.tolist())
        slot_of: dict[int, int] = {}  # in the order in which parameters are first met
        for name, derivative in chain(
            posed.by_equations(),
            posed.by_measurement(),
            posed.by_sensor_mass(),
            posed.by_laws(),
            posed.by_differences(space),
        ):
            row = space.index.get(name, -1)
            if row not in among:
                continue
            if row in slot_of:
                shared[slot_of[row]] += derivative * std[row]
            else:
                slot = slot_of[row] = len(slot_of)
                np.multiply(derivative, std[row], out=shared[slot], casting="same_kind")
        for p, name, own in posed.by_hit_directions():
            row = space.index.get(name, -1)
            if row in among:
                if row not in slot_of:
                    slot_of[row] = len(slot_of)
                    shared[slot_of[row]] = 0.0
                shared[slot_of[row], p] += own * std[row]
        return Columns(
            n=len(space),
            rows=np.fromiter(slot_of, dtype=np.int64),
            shared=shared[: len(slot_of)],
            own_rows=own_rows,
            own=shifts * std[own_rows][..., None, None],
        )

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

    def link_columns(
        self,
        hypothesis: Hypothesis,
        values: Mapping[str, float],
        link: int,
        pairs: Sequence[tuple[int, int]],
    ) -> ComplexArray:
        """Derivatives (n_pairs, P, m, 3, L) by an inertia of pairs of a link's six freedoms.

        Both triangles' mean.
        """
        changes = np.zeros((len(pairs), 6, 6))
        for change, (a, b) in zip(changes, pairs, strict=True):
            change[a, b] += 0.5
            change[b, a] += 0.5
        found = self._solved(hypothesis, values).found
        return found.by_link_inertia(link, changes, at_root=True)

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
        geometries = [model.geometry(ordinary, values) for model in self._models]
        plain = ordinary.assemblies(geometries, self.lines, values)
        return plain, [hypothesis.add_to(own, values) for own in plain]

    def _solved(self, hypothesis: Hypothesis, values: Mapping[str, float]) -> Solved:
        """The last solution is kept: a step is tried first, its derivatives asked for after."""
        kept = [self._last, self._last_columns and self._last_columns[0]]
        for old in kept:
            if old is not None and old.hypothesis is hypothesis and old.values == values:
                return old
        plain, assemblies = self._assemblies(hypothesis, values)
        found = respond(systems(assemblies), self._s_rad_s, self._hit)
        laws = [i.about for i in hypothesis.instances if i.linear_law(self.lines[0]) is not None]
        if laws:
            added = [
                sum(about.added(own.key, values) for about in laws if about is not None)
                for own in self.lines
            ]
            found = replace(found, added=np.stack(added))
        self._last = Solved(
            hypothesis, plain, assemblies, found, dict(values), self._slopes(), self._single
        )
        return self._last

    def _slopes(self) -> GeometrySlopes:
        """Stacked, anew only where a geometry's centre has moved."""
        own = [model.slopes() for model in self._models]
        if any(a is not b for a, b in zip(own, self._own_slopes, strict=False)) or not (
            self._own_slopes
        ):
            self._own_slopes, self._stacked = own, stacked_slopes(own)
        return self._stacked


def _of_sensors(posed: Solved, space: Space) -> tuple[Indices, ComplexArray]:
    """Rows (3, P, m) of the places of sensors, and their derivatives (3, P, m, 3, L)."""
    names, shifts = posed.by_places()
    return np.moveaxis(np.vectorize(space.index.__getitem__)(names), -1, 0), shifts


def _of_hits(posed: Solved, space: Space) -> tuple[Indices, ComplexArray]:
    """Likewise of hits; none where what is ordinary has no place of theirs."""
    names, shifts = posed.by_hit_places()
    rows = np.array([[[space.index.get(n, -1) for n in own] for own in of_p] for of_p in names])
    known = slice(0) if np.any(rows < 0) else slice(None)
    return np.moveaxis(rows, -1, 0)[known], shifts[known]
