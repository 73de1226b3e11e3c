"""The data of one stage of a fit: lines of postures, weighed, and the models that foretell them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.assembly import BASE
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.mounting_errors import mounting_error_columns
from armodal.analyzer.gap.model.posed import PosedModel, Postures
from armodal.analyzer.gap.model.space import Space
from armodal.analyzer.gap.model.weigh import Discrepancy, Quadratic, Weighing
from armodal.analyzer.gap.model.weighed_sums import costs_of, sloped, summed

__all__ = ["Stage", "models_of"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_KEPT = 2  # selections of postures whose last solutions are kept


class Stage:
    """The data of one annealing stage, ready to be fitted by any hypothesis."""

    def __init__(
        self,
        superset: Superset,
        lines: Sequence[PostureLines],
        discrepancy: Discrepancy,
        *,
        models: Sequence[PosedModel] | None = None,
        places: Sequence[ComplexArray] | None = None,
    ) -> None:
        self.lines = tuple(lines)
        self.models = tuple(models or models_of(superset, self.lines))
        self._superset, self._discrepancy = superset, discrepancy
        self.weighings = tuple(
            Weighing(
                own,
                superset.arm.tolerances,
                discrepancy,
                places=of,
                on_base=np.array(superset.point_link)[own.sensor_point] == BASE,
            )
            for own, of in zip_longest(self.lines, places or ())
        )
        self._first_of = _firsts(self.lines, self.models)
        self._groups: dict[tuple[int, ...], list[tuple[list[int], Postures]]] = {}

    def with_places(self, hypothesis: Hypothesis, values: Mapping[str, float]) -> Stage:
        """Return the stage with what single mountings' places and hits' aims may be off.

        `values` are near enough for what such small errors change.
        """
        places: list[ComplexArray] = [np.zeros((), dtype=np.complex128)] * len(self.lines)
        for rows, together in self.once(hypothesis, range(len(self.lines))):
            found = mounting_error_columns(
                together.response(hypothesis, values), self._superset.arm.tolerances
            )
            for p, i in rows:
                places[p] = found[i]
        self._groups.clear()  # the other takes its place: what was solved on this one is let go
        return Stage(
            self._superset, self.lines, self._discrepancy, models=self.models, places=places
        )

    def together(self, postures: Sequence[int] | None = None) -> list[tuple[list[int], Postures]]:
        """Return postures, all if none are given, in groups that are solved together."""
        used = tuple(range(len(self.lines)) if postures is None else postures)
        if used not in self._groups:
            if len(self._groups) == _KEPT:
                del self._groups[next(iter(self._groups))]
            self._groups[used] = Postures.in_groups(self.models, self.lines, used)
        return self._groups[used]

    def misfit(
        self, hypothesis: Hypothesis, values: Mapping[str, float], postures: Sequence[int]
    ) -> list[float]:
        """chi^2 / 2 of each posture; infinite where a response outgrows the arithmetic."""
        cost_of: dict[int, float] = {}
        for rows, together in self.once(hypothesis, postures):
            y = together.response(hypothesis, values).values
            own, at = zip(*rows, strict=True)
            costs = costs_of([self.weighings[p] for p in own], y[list(at)])
            cost_of |= dict(zip(own, costs, strict=True))
        return [cost_of[p] if cost_of[p] >= 0.0 else float("inf") for p in postures]

    def quadratics(
        self,
        hypothesis: Hypothesis,
        space: Space,
        values: Mapping[str, float],
        postures: Sequence[int],
    ) -> list[Quadratic]:
        """Misfit, gradient and curvature of each posture."""
        found: dict[int, Quadratic] = {}
        for rows, together in self.once(hypothesis, postures):
            y, columns = together.columns(hypothesis, space, values)
            for p, i in rows:
                found[p], _ = summed([self.weighings[p]], y[[i]], columns.of_posture(i), [0])
        return [found[p] for p in postures]

    def whole_quadratic(
        self,
        hypothesis: Hypothesis,
        space: Space,
        values: Mapping[str, float],
        postures: Sequence[int],
    ) -> tuple[Quadratic, tuple[float, ...]]:
        """Misfit, gradient and curvature of postures together, and the misfit of each."""
        gradient = np.zeros(len(space))
        curvature = np.zeros((len(space), len(space)))
        cost_of: dict[int, float] = {}
        for rows, together in self.once(hypothesis, postures):
            y, columns = together.columns(hypothesis, space, values)
            own, at = zip(*rows, strict=True)
            part, costs = summed([self.weighings[p] for p in own], y, columns, at)
            gradient += part.gradient
            curvature += part.curvature
            cost_of |= dict(zip(own, costs, strict=True))
        each = tuple(cost_of[p] for p in postures)
        return Quadratic(cost=sum(each), gradient=gradient, curvature=curvature), each

    def slope_about(
        self,
        about: tuple[Hypothesis, Space, Mapping[str, float]],
        hypothesis: Hypothesis,
        values: Mapping[str, float],
    ) -> tuple[float, Array]:
        """Misfit of a hypothesis, and its slope (n,) along another one's parameters elsewhere.

        Its own slope would be that of derivatives there; those near by cost a quarter and tell as
        well whether ordinary parameters can follow.

        Parameters
        ----------
        about
            A hypothesis, its space and values: where the derivatives are taken, which are kept.
        """
        cost, gradient = 0.0, np.zeros(len(about[1]))
        for rows, together in self.once(hypothesis, range(len(self.lines))):
            near = together.columns(*about)
            y = together.response(hypothesis, values).values
            own, at = zip(*rows, strict=True)
            part, along = sloped([self.weighings[p] for p in own], y, near, at)
            cost += part
            gradient += along
        return cost, gradient

    def once(
        self, hypothesis: Hypothesis, postures: Sequence[int]
    ) -> Iterator[tuple[list[tuple[int, int]], Postures]]:
        """Give what is solved together, and which row of it each posture has.

        Soft and hard hits of a posture share one while nothing follows the level.
        """
        first_of = range(len(self.lines)) if hypothesis.level_dependent else self._first_of
        for own, together in self.together(tuple(dict.fromkeys(first_of[p] for p in postures))):
            yield [(p, own.index(first_of[p])) for p in postures if first_of[p] in own], together


def models_of(superset: Superset, lines: Sequence[PostureLines]) -> list[PosedModel]:
    """Return a model for each of the lines; soft and hard hits of a posture share one."""
    models: dict[tuple[float, ...], PosedModel] = {}
    found = []
    for own in lines:
        angles = tuple(own.joints_rad.tolist())
        if angles not in models:
            models[angles] = PosedModel(superset, own.joints_rad)
        found.append(models[angles])
    return found


def _firsts(lines: Sequence[PostureLines], models: Sequence[PosedModel]) -> list[int]:
    """For each the first that every model without the level answers alike."""
    firsts: list[int] = []
    for p, own in enumerate(lines):
        alike = (
            q for q in dict.fromkeys(firsts) if models[q] is models[p] and lines[q].is_hit_as(own)
        )
        firsts.append(next(alike, p))
    return firsts
