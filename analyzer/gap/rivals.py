"""Rivals for what the present hypothesis does not explain: all looked at, the best fitted sharply.

Where the present hypothesis comes near the measurement, a linear look at all effects on the sharp
lines tells which deserve a fit. Where it does not, that look misleads, and the search anneals: the
most promising effects are fitted on broad lines first, the best of those on sharper ones.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analyzer.gap.effects import link_axis
from analyzer.gap.effects.effect import Instance
from analyzer.gap.fit import Fit, Stage, fit_hypothesis
from analyzer.gap.hypothesis import Hypothesis
from analyzer.gap.library import all_instances
from analyzer.gap.ordinary import across
from analyzer.gap.scan import Candidate, scan_axes, scan_instances
from analyzer.gap.scan_dampers import scan_dampers
from analyzer.gap.scan_postures import scan_compensators
from analyzer.gap.sensors import scan_sensors

__all__ = ["Rivals", "find_rivals"]

_FIRST_STEPS = 2
_MOST_PROMISING = 4
_LOOKED_AT, _COARSE, _MIDDLE, _FINALISTS = 24, 9, 4, 4
_LOOKED_AT_SHARPLY = 10
# A servo's part of the joint's compliance and its rotor, of what is typical, as starts.
_SERVO_PARTS, _ROTORS = (0.1, 0.25), (0.5, 1.5, 3.0)
_FROM_START, _ALONE, _BETTER, _FEWEST = 10, 18, 12, 3
# Times the least cost: what costs more is not it, on the widest lines and on broad ones.
_BEHIND, _BEHIND_BROADLY = 2.2, 1.5
_OBVIOUS = 0.3  # of the plain fit's cost there: what costs less needs no other look
_LEAP, _MOST_LEAPS = 0.7, 4  # of the cost; rounds
_SPLIT = 2  # leading fits in which an axis may have a part of its link before it
_FEW_PARAMETERS, _MANY_STEPS, _WIDE_STEPS = 6, 9, 3
_PARTS = (1.0, 0.3, 0.1)  # of a linear step, tried as starts
# Candidates of one kind that are fitted: alike as they are, they would crowd out the others.
_AT_MOST = {
    "link_axis": 6,
    "gravity_compensator": 2,
    "link_bending": 2,
    "link_torsion": 2,
    "load_damping": 2,
    "nonproportional": 2,
}
_NEAR = 0.9  # misfit a residual below which a linear look on the sharp lines is trusted
_BELIEVABLE = (
    4.9  # prior deviations: beyond, at the limits of what is ordinary, the fit went astray
)
# Where soft and hard hits are told apart: a joint that follows the level leaves much, and is near.
_NEAR_BY_LEVEL = 4.0
_WORTH_BROAD, _WORTH_SHARP = 4.0, 15.0  # of cost by the linear look; less is not worth a fit
# Evidence behind the best at which a rival is dropped: sharper lines weigh some five times more.
_HOPELESS = 400.0
_LITTLE = 8.0  # of evidence after two steps: less becomes no name
_PROMISE = 1.0  # of evidence over the present hypothesis, to be fitted on sharper lines
_MISREAD = ("flipped_axis", "swapped_axes", "wrong_point")
_ASTRAY = (
    "base",
    "bearing",
    "coupling",
    "encoder_offset",
    "hysteretic",
    "link_bending",
    "payload",
    "released_joint",
    "rotor",
    "sensor_mass",
)
_SOUGHT = ("gravity_compensator", "nonproportional")  # by a look of their own
_SEVERAL_STARTS = ("link_axis", "gravity_compensator")
_STEPS = 24  # a finalist converges within these

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rivals:
    """The hypothesis so far and its rivals on the sharp lines, best evidence first."""

    present: Fit
    rivals: tuple[Fit, ...]
    looked_at: tuple[Candidate, ...]  # all, by linear gain


def find_rivals(
    stages: Sequence[Stage],
    present: Hypothesis,
    *,
    postures: Sequence[int] | None = None,
    start: dict[str, float] | None = None,
    tell: Progress = lambda _: None,
) -> Rivals:
    """Fit the present hypothesis and the effects that could improve on it.

    Parameters
    ----------
    stages
        Widest, broad, middle and sharp lines of the same postures.
    """
    widest, broad, middle, sharp = stages
    tell("the arm as believed" if not present.instances else present.name)
    at_widest = fit_hypothesis(widest, present, start=start, postures=postures, max_iterations=7)
    base = _further(broad, at_widest, postures, 5)
    at_middle = _further(middle, base, postures, 5)
    at_sharp = _further(sharp, at_middle, postures, 8)
    per_line = 2.0 * at_sharp.cost / sum(w.n for w in sharp.weighings)
    near = _NEAR_BY_LEVEL if present.ordinary.level_span else _NEAR
    lost = at_sharp.farthest > _BELIEVABLE
    if per_line < near and not lost:
        least = base.cost
        at_sharp = _further(sharp, at_sharp, postures, _STEPS)
        looked_at = _looked_at(sharp, at_sharp, start or {}, from_start=False)
        chosen = _most_promising(looked_at, _WORTH_SHARP, each_kind=False)[:_LOOKED_AT_SHARPLY]
        first = _first_steps(sharp, at_sharp, chosen, postures, start or {})
        # The best after two steps, and those that promise most: some need more than two.
        promising = [c.instance.key for c in looked_at[:_MOST_PROMISING]]
        best = _leading(first, None)[: _FINALISTS - 1]
        best += [f for f in first if _key(f) in promising and _key(f) not in map(_key, best)][:2]
        little = at_sharp.evidence - _LITTLE
        best = [f for i, f in enumerate(best) if i == 0 or f.evidence < little]
    else:
        looked_at, wide = _from_the_start(widest, present, postures, start or {}, alone=lost)
        coarse = [_further(broad, f, postures, _FIRST_STEPS) for f in _not_hopeless(wide, _BEHIND)]
        if not lost and wide[0].cost > _OBVIOUS * at_widest.cost:
            looked_at = _looked_at(broad, base, start or {}, from_start=True)
            chosen = _most_promising(looked_at, _WORTH_BROAD, each_kind=True)
            coarse += _first_steps(broad, base, chosen, postures, start or {})
        coarse.sort(key=lambda f: f.cost)
        leading = _not_hopeless(coarse, _BEHIND_BROADLY)[:_COARSE]
        coarse += _axes_of_bearings(broad, present, leading, postures)
        coarse.sort(key=lambda f: f.cost)
        best = []
        for f in _not_hopeless(coarse, _BEHIND_BROADLY)[:_COARSE]:
            tell(f.hypothesis.name)
            best.append(_further(broad, f, postures, 6))
        least = min(f.cost for f in best)
        best += _split_axes(broad, _leading(best, base)[:_SPLIT], postures, 6)
        best = [_further(middle, f, postures, 5) for f in _leading(best, base)[:_MIDDLE]]
        best = _leading(best, at_middle)
    behind = _behind_joints(broad, base, postures)
    behind = [f for f in _leading(behind, base)[:1] if f.cost < _BEHIND * least]
    best += [f for f in behind if _key(f) not in map(_key, best)]
    finals = []
    for f in best[: _FINALISTS + 2]:
        tell(f"sharply: {f.hypothesis.name}")
        finals.append(_further(sharp, f, postures, 8))
    finals.sort(key=lambda f: f.evidence)
    finals += _split_axes(sharp, finals[:1], postures, 8)
    finals = _leading(finals, None)
    finals = [
        f if f.converged else _further(sharp, f, postures, _STEPS)
        for f in finals
        if f.evidence < finals[0].evidence + _HOPELESS
    ]
    return Rivals(
        present=at_sharp,
        rivals=tuple(sorted(finals, key=lambda f: f.evidence)),
        looked_at=tuple(looked_at),
    )


def _first_steps(
    stage: Stage,
    base: Fit,
    candidates: Sequence[Candidate],
    postures: Sequence[int] | None,
    start: dict[str, float],
) -> list[Fit]:
    """The first steps of each promising candidate, best cost first."""
    present = base.hypothesis
    fits = []
    for candidate in candidates:
        begin = base.values
        richer = replace(present, instances=(*present.instances, candidate.instance))
        if candidate.instance.effect.name in _MISREAD and not candidate.begin:
            # Unless it is small, the fit without it went astray.
            begin = _better_start(stage, richer, [begin, start or {}], postures)
        if candidate.begin:
            starts = [_part_of_the_way(base.values, candidate, part) for part in _PARTS]
            begin = _better_start(stage, richer, [begin, *starts], postures)
        fits.append(
            fit_hypothesis(
                stage, richer, start=begin, postures=postures, max_iterations=_FIRST_STEPS
            )
        )
    return sorted(fits, key=lambda f: f.cost)


def _part_of_the_way(
    values: dict[str, float], candidate: Candidate, part: float
) -> dict[str, float]:
    """Values between the present best and what the linear look promises; places at once."""
    sizes = (candidate.instance.size, *candidate.instance.sizes)
    start = dict(candidate.begin)
    for name, reached in candidate.begin.items():
        if name in values:
            start[name] = values[name] + part * (reached - values[name])
        elif name in sizes:
            start[name] = part * reached
    return start


def _better_start(
    stage: Stage,
    hypothesis: Hypothesis,
    starts: Sequence[dict[str, float]],
    postures: Sequence[int] | None,
) -> dict[str, float]:
    """The start of least cost."""
    space = hypothesis.space()
    used = range(len(stage.lines)) if postures is None else postures

    def cost(start: dict[str, float]) -> float:
        u = space.start(start)
        return sum(stage.misfit(hypothesis, space.values(u), used)) + 0.5 * float(u @ u)

    return min(starts, key=cost)


def _from_the_start(
    stage: Stage,
    present: Hypothesis,
    postures: Sequence[int] | None,
    start: dict[str, float],
    *,
    alone: bool,
) -> tuple[list[Candidate], list[Fit]]:
    """Fits from where nothing is fitted yet: the plain fit may have gone where none comes back.

    On the widest lines nearly every start finds its way. Where these fits stand alone, more of
    them. Least cost first.
    """
    first = fit_hypothesis(stage, present, start=start, postures=postures, max_iterations=0)
    looked_at = _looked_at(stage, first, start, from_start=False)
    chosen = _most_promising(looked_at, _WORTH_BROAD, each_kind=True)
    chosen = chosen[: _ALONE if alone else _FROM_START]
    instances = [candidate.instance for candidate in chosen]
    known = {instance.key for instance in (*present.instances, *instances)}
    instances += [
        i
        for i in all_instances(present.ordinary)
        if i.effect.name in _ASTRAY and i.key not in known and _goes_with(i, present)
    ]
    fits = []
    for instance in instances:
        richer = replace(present, instances=(*present.instances, instance))
        fits.append(_quickly(stage, richer, start, postures, _WIDE_STEPS))
    fits.sort(key=lambda f: f.cost)
    better = []
    for fit in _not_hopeless(fits, _BEHIND)[:_BETTER]:
        many = len(fit.hypothesis.instances[-1].parameters) > _FEW_PARAMETERS
        steps = _MANY_STEPS if many else _WIDE_STEPS
        better.append(_quickly(stage, fit.hypothesis, fit.values, postures, steps))
    return looked_at, sorted(better, key=lambda f: f.cost)


def _not_hopeless(fits: Sequence[Fit], behind: float) -> list[Fit]:
    """Some at least, and what does not cost far more than the best; of fits by rising cost."""
    return [f for i, f in enumerate(fits) if i < _FEWEST or f.cost < behind * fits[0].cost]


def _quickly(
    stage: Stage,
    hypothesis: Hypothesis,
    start: dict[str, float],
    postures: Sequence[int] | None,
    steps: int,
) -> Fit:
    """A fit of which only cost and values count."""
    return fit_hypothesis(
        stage, hypothesis, start=start, postures=postures, max_iterations=steps, closing=False
    )


def _behind_joints(stage: Stage, fit: Fit, postures: Sequence[int] | None) -> list[Fit]:
    """Servos from several starts that leave each joint as soft as it was: no linear look sees one.

    Between them the plain fit has the whole compliance in the joint's own spring.
    """
    taken = {instance.key for instance in fit.hypothesis.instances}
    found = []
    for servo in all_instances(fit.hypothesis.ordinary):
        if servo.effect.name != "servo" or servo.key in taken:
            continue
        soft, _, rotor = servo.parameters
        name = f"ln k {servo.place}"
        starts = [
            {
                **fit.values,
                soft.name: float(part * np.exp(-fit.values[name])),
                rotor.name: turns * rotor.mean,
                name: fit.values[name] - float(np.log(1.0 - part)),
            }
            for part in _SERVO_PARTS
            for turns in _ROTORS
        ]
        richer = replace(fit.hypothesis, instances=(*fit.hypothesis.instances, servo))
        begin = _better_start(stage, richer, starts, postures)
        found.append(
            fit_hypothesis(stage, richer, start=begin, postures=postures, max_iterations=4)
        )
    return found


def _axes_of_bearings(
    stage: Stage, present: Hypothesis, fits: Sequence[Fit], postures: Sequence[int] | None
) -> list[Fit]:
    """A bearing that gives way one way rather than two may stand for an axis in the link beyond."""
    ordinary = present.ordinary
    taken = {instance.key for instance in present.instances}
    found = []
    for fit in fits:
        bearing = fit.hypothesis.instances[-1]
        if bearing.effect.name != "bearing":
            continue
        link = next(i for i, j in enumerate(ordinary.arm.joints) if j.name == bearing.place)
        if ("link_axis", ordinary.arm.joints[link].link.name) in taken:
            continue
        size = np.array([fit.values[name] for name in bearing.sizes])
        turn = across(np.asarray(ordinary.arm.joints[link].axis))
        values = {k: v for k, v in fit.values.items() if k not in bearing.owned}
        for signs in ((1.0, 1.0), (1.0, -1.0)):
            direction = turn @ (np.sqrt(size) * signs)
            direction = direction / np.linalg.norm(direction)
            axis = link_axis.at_axis(ordinary, link, direction, np.zeros(3))
            richer = replace(present, instances=(*present.instances, axis))
            start = {**values, axis.size: float(np.sum(size))}
            found.append(
                fit_hypothesis(stage, richer, start=start, postures=postures, max_iterations=4)
            )
    return found


def _split_axes(
    stage: Stage, fits: Sequence[Fit], postures: Sequence[int] | None, steps: int
) -> list[Fit]:
    """Axes with some of their link's points, and a part of its mass, between joint and axis."""
    found = []
    for fit in fits:
        *others, axis = fit.hypothesis.instances
        if axis.effect.name != "link_axis" or axis.describe is None or axis.pieces:
            continue
        ordinary, where = fit.hypothesis.ordinary, axis.describe(fit.values)
        link = next(i for i, j in enumerate(ordinary.arm.joints) if j.link.name == axis.place)
        direction, point = np.asarray(where["direction"]), np.asarray(where["point_m"])
        start = {k: v for k, v in fit.values.items() if k not in axis.shapes}
        for before in link_axis.splits(ordinary, link):
            split = link_axis.at_axis(ordinary, link, direction, point, before=before)
            if any(split.excludes(other) for other in others):
                continue
            richer = replace(fit.hypothesis, instances=(*others, split))
            found.append(
                fit_hypothesis(stage, richer, start=start, postures=postures, max_iterations=steps)
            )
    return found


def _key(fit: Fit) -> tuple[str, str]:
    return fit.hypothesis.instances[-1].key


def _further(stage: Stage, fit: Fit, postures: Sequence[int] | None, steps: int) -> Fit:
    """Some steps more; and again while the cost still falls by leaps."""
    if fit.converged and fit.on is not None and fit.on[0] is stage:
        return fit
    for _ in range(_MOST_LEAPS):
        further = fit_hypothesis(
            stage, fit.hypothesis, resumed=fit, postures=postures, max_iterations=steps
        )
        leapt = further.n_iterations == steps and further.cost < _LEAP * further.first_cost
        fit = further
        if not leapt:
            break
    return fit


def _leading(fits: Sequence[Fit], base: Fit | None) -> list[Fit]:
    """By evidence; one for each effect and place, and none hopeless beside the best or the base."""
    if not fits:
        return []
    kept: dict[tuple[tuple[str, str], ...], Fit] = {}
    for fit in sorted(fits, key=lambda f: f.evidence):
        kept.setdefault(tuple(i.key for i in fit.hypothesis.instances), fit)
    ordered = list(kept.values())
    worst = ordered[0].evidence + _HOPELESS
    if base is not None:
        worst = min(worst, base.evidence - _PROMISE)
    return [f for f in ordered if f.evidence < worst]


def _looked_at(
    stage: Stage, base: Fit, start: dict[str, float], *, from_start: bool
) -> list[Candidate]:
    """Every effect at every place by its linear gain; sensors also beside the first guess."""
    hypothesis = base.hypothesis
    taken = {instance.key for instance in hypothesis.instances}
    instances = [
        i
        for i in all_instances(hypothesis.ordinary)
        if i.key not in taken and _goes_with(i, hypothesis)
    ]
    plain = [i for i in instances if i.effect.name not in _SOUGHT]
    found = scan_instances(stage, base, plain)
    found += scan_compensators(stage, base, instances)
    found += scan_dampers(stage, base, instances)
    axes_taken = [place for name, place in taken if name == "link_axis"]
    found += scan_axes(stage, base, exclude=axes_taken)
    found += scan_sensors(stage, hypothesis, base.values)
    if from_start:
        first = hypothesis.space()
        found += scan_sensors(stage, hypothesis, first.values(first.start(start)))
    best: dict[tuple[str, str], list[Candidate]] = {}
    for candidate in sorted(found, key=lambda c: -c.gain):
        same = best.setdefault(candidate.instance.key, [])
        if not same or candidate.instance.effect.name in _SEVERAL_STARTS:
            same.append(candidate)
    every = [c for group in best.values() for c in group if c.instance.key not in taken]
    return sorted(every, key=lambda c: -c.gain)


def _goes_with(instance: Instance, present: Hypothesis) -> bool:
    return not any(instance.excludes(other) for other in present.instances)


def _most_promising(
    candidates: Sequence[Candidate], worth: float, *, each_kind: bool
) -> list[Candidate]:
    """The best by linear gain; with `each_kind` the best place of every effect first.

    A linear look about a fit that went astray promises some effects more than there is to gain.
    """
    worthy = [c for c in candidates if c.gain >= worth]
    if each_kind:
        # A gain of the whole sensor widens a prior, one at a point is a parameter more.
        kinds: dict[tuple[str, bool], Candidate] = {}
        for c in worthy:
            kinds.setdefault((c.instance.effect.name, bool(c.instance.relaxes)), c)
        first = list(kinds.values())
        worthy = first + [c for c in worthy if c not in first]
    chosen: list[Candidate] = []
    taken: dict[str, int] = {}
    for candidate in worthy:
        if len(chosen) == _LOOKED_AT:
            break
        name = candidate.instance.effect.name
        taken[name] = taken.get(name, 0) + 1
        if taken[name] <= _AT_MOST.get(name, _LOOKED_AT):
            chosen.append(candidate)
    return chosen
