"""What promises most where the present hypothesis stands, begun on the sharp lines."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.search.beginnings import LEADING, promising_beginnings
from armodal.analyzer.gap.search.best_fits import hopeful
from armodal.analyzer.gap.search.first_steps import first_steps
from armodal.analyzer.gap.search.race import Race
from armodal.analyzer.gap.search.scan import LOOK, Candidate

__all__ = ["Nearby"]

IsWanted = Callable[[Instance, float], bool]


class Nearby:
    """Effects begun near the present hypothesis, each once however often it is asked for.

    Parameters
    ----------
    races
        Of every stage, from the widest lines to the sharp ones.
    base
        The present hypothesis on the widest lines, on middle ones and on sharp ones.
    looked
        Candidates by a linear look about it, best first.
    blind
        Instances of which those are begun from their own beginnings that a look does not tell.
    start
        Where effects begin.
    most
        Of the looked at, as many are begun each time.
    """

    def __init__(
        self,
        races: Mapping[Stage, Race],
        base: Sequence[Fit],
        looked: Sequence[Candidate],
        blind: Sequence[Instance],
        start: Mapping[str, float],
        *,
        most: int,
    ) -> None:
        self._races, self._stages = races, list(races)
        self._base, self._looked, self._blind = base, looked, blind
        self._start, self._most = start, most
        self._done: set[tuple[object, ...]] = set()

    def begun(self, is_wanted: IsWanted, is_begun: IsWanted) -> list[Fit]:
        """Some steps on sharp lines of what was not begun before.

        Parameters
        ----------
        is_wanted
            Asked of the nats that a look promises.
        is_begun
            Of those that a beginning does, on middle lines.
        """
        sharp = self._races[self._stages[-1]]
        promising = [
            (number, c)
            for number, c in enumerate(self._looked)
            if c.gain > LOOK and is_wanted(c.instance, c.gain)
        ]
        found = [
            first_steps(sharp, self._base[-1], c, self._start, choose_on=self._stages[1])
            for number, c in promising[: self._most]
            if self._is_new(number)
        ]
        return [*found, *self._from_beginnings(is_begun)]

    def _is_new(self, *key: object) -> bool:
        is_new = key not in self._done
        self._done.add(key)
        return is_new

    @cached_property
    def _beginnings(self) -> list[tuple[Instance, list[tuple[float, Mapping[str, float]]]]]:
        return promising_beginnings(self._stages[-2], self._base[-2], self._blind)

    def _from_beginnings(self, is_begun: IsWanted) -> list[Fit]:
        """Fits on middle lines, begun on sharp ones, of what only its own beginnings tell."""
        middle, sharp = (self._races[stage] for stage in self._stages[-2:])
        present = self._base[-2].hypothesis
        near: list[Fit] = []
        for place, (instance, beginnings) in enumerate(self._beginnings[:LEADING]):
            richer = replace(present, instances=(*present.instances, instance))
            # What promises most may lead back to none, and the next one not. What leads is begun
            # anyway: middle lines promise less than sharp ones keep.
            begun = [
                begin
                for number, (gain, begin) in enumerate(beginnings[:LEADING])
                if gain > LOOK
                and (place == number == 0 or is_begun(instance, gain))
                and self._is_new(instance.key, number)
            ]
            near += [middle.to_its_end(middle.fit(richer, start=b)) for b in begun]
        return [sharp.fit(fit.hypothesis, resumed=fit) for fit in hopeful(near)]
