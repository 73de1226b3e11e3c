"""A candidate's first steps, from the best of the places where a fit with it may begin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from armodal.analyzer.gap.inference.fit import Fit, Stage, best_starting_point
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.search.race import Race
from armodal.analyzer.gap.search.scan import Candidate

__all__ = ["first_steps"]

_PARTS = (1.0, 0.3, 0.1)  # of a linear step, tried as starting points
_LARGEST = 3.0  # of a size's prior deviation, where it is zero at least: parts of it are tried too


def first_steps(
    race: Race,
    about: Fit,
    candidate: Candidate,
    start: Mapping[str, float],
    *,
    own_too: bool = False,
    choose_on: Stage | None = None,
) -> Fit:
    """Some steps of a candidate from the best of its beginnings; on wide lines from its own too.

    What begins best may lead nowhere: a body of no mass with a moment, beside ordinary errors that
    have taken on the rest. Its own is where its file says that a fit begins, and there ordinary
    errors begin anew.
    """
    present = about.hypothesis
    richer = replace(present, instances=(*present.instances, candidate.instance))
    values = about.values
    # Of no size, but with the shape that promises most: of another it may promise nothing.
    sizes = (candidate.instance.size, *candidate.instance.sizes)
    shape = {n: v for n, v in candidate.begin.items() if n not in values and n not in sizes}
    nothing = {**values, **shape}
    starting_points: list[Mapping[str, float]] = [nothing, {**shape, **start}]
    if candidate.begin:
        starting_points += [_part_of_the_way(values, candidate, part) for part in _PARTS]
    if candidate.instance.initial_values is not None:
        starting_points += candidate.instance.initial_values(values)
    starting_points += _of_every_size(values, candidate)
    best = best_starting_point(choose_on or race.stage, richer, starting_points)
    fits = [race.fit(richer, start=best)]
    if own_too and _has_own_start(candidate.instance):
        fits.append(race.to_its_end(race.fit(richer, start=start)))
    elif own_too and best is not nothing:
        fits.append(race.fit(richer, start=nothing))
    return min(fits, key=lambda fit: fit.evidence)


def _has_own_start(instance: Instance) -> bool:
    return any(p.first != p.mean for p in (*instance.parameters, *instance.relaxes.values()))


def _of_every_size(
    values: Mapping[str, float], candidate: Candidate
) -> Sequence[Mapping[str, float]]:
    """Values with a compliance, a mass or a damper of several sizes; places as the look has them.

    A spring may bring a mode that comes down into the lines from above: from a size on its wrong
    side a fit leads back to none.
    """
    instance = candidate.instance
    of_size = {p.name: p for p in (*instance.parameters, *instance.relaxes.values())}
    size = of_size.get(instance.size)
    if size is None or (size.mean, size.low) != (0.0, 0.0):
        return ()
    reached = {**values, **_part_of_the_way(values, candidate, 1.0)}
    return [{**reached, size.name: part * _LARGEST * size.std} for part in _PARTS]


def _part_of_the_way(
    values: Mapping[str, float], candidate: Candidate, part: float
) -> dict[str, float]:
    """Values between the present ones and what the linear look promises; places at once."""
    sizes = (candidate.instance.size, *candidate.instance.sizes)
    start = dict(candidate.begin)
    for name, reached in candidate.begin.items():
        if name in values:
            start[name] = values[name] + part * (reached - values[name])
        elif name in sizes:
            start[name] = part * reached
    return start
