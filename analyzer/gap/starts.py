"""Where the fits of rivals begin: beside the present fit, at the unfitted start, behind joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.effects.effect import Instance
from armodal.analyzer.gap.effects.long_link import long_links
from armodal.analyzer.gap.fit import TOLERANCE, Fit, Stage, better_start, fit_hypothesis
from armodal.analyzer.gap.hypothesis import Hypothesis
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.looks import goes_with, look_at_all, most_promising
from armodal.analyzer.gap.ordinary import Ordinary, across
from armodal.analyzer.gap.scan import Candidate, beside

__all__ = [
    "BEHIND",
    "FIRST_STEPS",
    "WORTH_BROAD",
    "axes_of_bearings",
    "bearings_of_axes",
    "behind_joints",
    "every_bearing",
    "first_steps",
    "from_the_start",
    "not_hopeless",
    "split_axes",
    "spread_axes",
    "spread_of",
    "taken_out",
]

FIRST_STEPS = 2
BEHIND = 1.8  # times the least cost on the widest lines: what costs more is not it
_SAME = 1.005  # likewise: two fits of the same effects this near are at the same place
_FAR_BEHIND = 4.0  # likewise on any lines, also for the few best
WORTH_BROAD = 4.0  # of cost by the linear look; less is not worth a fit
# A servo's part of the joint's compliance and its rotor, of what is typical, as starts.
_SERVO_PARTS, _ROTORS = (0.1, 0.25), (0.5, 1.5, 3.0)
_SERVO_STEPS, _SERVOS = 4, 3
_HARDLY = 0.05  # of the way to what a servo must cost
_FROM_START, _ALONE, _AGAIN, _FEWEST = 10, 18, 14, 3
_WIDE_STEPS, _MANY_STEPS, _FEW_PARAMETERS, _BETTER, _BETTER_AGAIN = 3, 9, 6, 9, 6
_CERTAIN = 0.1  # of the plain fit's cost: what leaves less is found
_LONG, _LONG_START = ("link_bending", "link_torsion"), 0.03  # of the size's deviation
_SHAPED = "gravity_compensator"
_ALONG = 0.7  # cosine: an axis nearer to its link's line twists it, one further bends it
_BEARING_STEPS = 4
_PARTS = (1.0, 0.3, 0.1)  # of a linear step, tried as starts
_MISREAD = ("flipped_axis", "swapped_axes", "wrong_point")
# Tried at every place: about an unfitted start a linear look ranks places badly.
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


def first_steps(
    stage: Stage,
    base: Fit,
    candidates: Sequence[Candidate],
    start: Mapping[str, float],
) -> list[Fit]:
    """The first steps of each promising candidate, unclosed, best cost first."""
    present = base.hypothesis
    fits = []
    for candidate in candidates:
        begin: Mapping[str, float] = base.values
        richer = replace(present, instances=(*present.instances, candidate.instance))
        if candidate.instance.effect.name in _MISREAD and not candidate.begin:
            # Unless it is small, the fit without it went astray.
            begin = better_start(stage, richer, [begin, start])
        if candidate.begin:
            starts = [_part_of_the_way(base.values, candidate, part) for part in _PARTS]
            begin = better_start(stage, richer, [begin, *starts])
        fits.append(_quickly(stage, richer, begin, FIRST_STEPS))
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


def from_the_start(
    stage: Stage,
    present: Hypothesis,
    start: Mapping[str, float],
    *,
    alone: bool,
    again: bool,
    plain_cost: float,
) -> list[Fit]:
    """Fits from where nothing is fitted yet: the plain fit may have gone where none comes back.

    On the widest lines nearly every start finds its way. Where these fits stand alone, more of
    them; where something was named already and `start` is a fit with it, only those that a linear
    look about it promises. Least cost first.
    """
    first = fit_hypothesis(stage, present, start=start, max_iterations=0)
    looked_at = look_at_all(stage, first, start, from_start=False)
    chosen = most_promising(looked_at, WORTH_BROAD, each_kind=True)
    chosen = chosen[: _AGAIN if again else _ALONE if alone else _FROM_START]
    instances = [candidate.instance for candidate in chosen]
    fits = _wide_fits(stage, first, [i for i in instances if i.effect.name != _SHAPED], start)
    fits += [_wide_shaped(stage, first, c) for c in chosen if c.instance.effect.name == _SHAPED]
    found = min((f.cost for f in fits), default=np.inf) < _CERTAIN * plain_cost
    if not (again or found):
        known = {instance.key for instance in (*present.instances, *instances)}
        every_place = [
            i
            for i in all_instances(present.ordinary)
            if i.effect.name in _ASTRAY and i.key not in known and goes_with(i, present)
        ]
        fits += _wide_fits(stage, first, every_place, start)
    fits.sort(key=lambda f: f.cost)
    better = []
    for fit in not_hopeless(fits, BEHIND)[: _BETTER_AGAIN if again else _BETTER]:
        steps = _MANY_STEPS if _has_many(fit) else _WIDE_STEPS
        better.append(_quickly(stage, fit.hypothesis, fit.values, steps))
    return sorted(better, key=lambda f: f.cost)


def _wide_fits(
    stage: Stage,
    first: Fit,
    instances: Sequence[Instance],
    start: Mapping[str, float],
) -> list[Fit]:
    """Some steps with each instance from the first, unfitted one."""
    ready = beside(stage, first, instances)
    begun = {fit.last.key: fit for fit in ready}
    fits = []
    for instance in instances:
        resumed = begun.get(instance.key)
        present = first.hypothesis
        richer = replace(present, instances=(*present.instances, instance))
        if instance.effect.name in _LONG:
            # A first step from none at all goes astray where much is missing.
            size = next(p for p in instance.parameters if p.name == instance.size)
            some = {**start, size.name: _LONG_START * size.std}
            begin = better_start(stage, richer, [start, some])
            fits.append(_quickly(stage, richer, begin, _WIDE_STEPS))
        elif resumed is not None and resumed.hypothesis == richer:
            fits.append(_quickly(stage, richer, {}, _WIDE_STEPS, resumed=resumed))
        else:
            fits.append(_quickly(stage, richer, start, _WIDE_STEPS))
    return fits


def _wide_shaped(stage: Stage, first: Fit, candidate: Candidate) -> Fit:
    """From where the linear look put it: of no size it has no shape that a step could change."""
    present = first.hypothesis
    richer = replace(present, instances=(*present.instances, candidate.instance))
    starts = [_part_of_the_way(first.values, candidate, part) for part in _PARTS]
    return _quickly(stage, richer, better_start(stage, richer, starts), _WIDE_STEPS)


def _has_many(fit: Fit) -> bool:
    return len(fit.last.parameters) > _FEW_PARAMETERS


def not_hopeless(fits: Sequence[Fit], behind: float, few_behind: float = _FAR_BEHIND) -> list[Fit]:
    """What costs less than `behind` times the best, the first few `few_behind`; by rising cost."""
    fits = _apart(fits)
    allowed = [few_behind if i < _FEWEST else behind for i in range(len(fits))]
    return [f for f, most in zip(fits, allowed, strict=True) if f.cost <= most * fits[0].cost]


def _apart(fits: Sequence[Fit]) -> list[Fit]:
    """Without those that came to where a better one of the same effects and places already is."""
    kept: list[Fit] = []
    for fit in fits:
        keys = [i.key for i in fit.hypothesis.instances]
        same = (f for f in kept if [i.key for i in f.hypothesis.instances] == keys)
        if not any(fit.cost < _SAME * f.cost for f in same):
            kept.append(fit)
    return kept


def _quickly(
    stage: Stage,
    hypothesis: Hypothesis,
    start: Mapping[str, float],
    steps: int,
    *,
    resumed: Fit | None = None,
    least_gain: float = 0.0,
) -> Fit:
    """A fit of which only cost and values count, and where evidence is known nearly enough."""
    return fit_hypothesis(
        stage,
        hypothesis,
        start=start,
        max_iterations=steps,
        tolerance=max(TOLERANCE, least_gain),
        closing=False,
        resumed=resumed,
    )


def behind_joints(stage: Stage, fit: Fit, worth: float) -> list[Fit]:
    """Servos from several starts that leave each joint as soft as it was: no linear look sees one.

    Between them the plain fit has the whole compliance in the joint's own spring. The best few of
    those that cost less than what they are worth for; a fit that hardly comes nearer to it ends.
    """
    least_gain = _HARDLY * (fit.cost - worth)
    taken = {instance.key for instance in fit.hypothesis.instances}
    found = []
    for servo in all_instances(fit.hypothesis.ordinary):
        known = servo.key in taken or not goes_with(servo, fit.hypothesis)
        if servo.effect.name != "servo" or known:
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
        begin = better_start(stage, richer, starts)
        found.append(_quickly(stage, richer, begin, _SERVO_STEPS, least_gain=least_gain))
    found.sort(key=lambda f: f.cost)
    return [f for f in found[:_SERVOS] if f.cost < worth]


def axes_of_bearings(stage: Stage, present: Hypothesis, fits: Sequence[Fit]) -> list[Fit]:
    """A bearing that gives way one way rather than two may stand for an axis in the link beyond."""
    ordinary = present.ordinary
    taken = {instance.key for instance in present.instances}
    found = []
    for fit in fits:
        bearing = fit.last
        if bearing.effect.name != "bearing":
            continue
        link = next(i for i, j in enumerate(ordinary.arm.joints) if j.name == bearing.place)
        size = np.array([fit.values[name] for name in bearing.sizes])
        if ("link_axis", ordinary.arm.joints[link].link.name) in taken or not np.any(size):
            continue
        turn = across(np.asarray(ordinary.arm.joints[link].axis))
        values = {k: v for k, v in fit.values.items() if k not in bearing.owned}
        for signs in ((1.0, 1.0), (1.0, -1.0)):
            direction = turn @ (np.sqrt(size) * signs)
            direction = direction / np.linalg.norm(direction)
            axis = link_axis.at_axis(ordinary, link, direction, np.zeros(3))
            richer = replace(present, instances=(*present.instances, axis))
            start = {**values, axis.size: float(np.sum(size))}
            found.append(fit_hypothesis(stage, richer, start=start, max_iterations=4))
    return found


def bearings_of_axes(stage: Stage, present: Hypothesis, fits: Sequence[Fit]) -> list[Fit]:
    """An axis in a link may stand for the bearing of the joint before it, or of that beyond."""
    free = _bearings(present)
    found = []
    for fit in fits:
        axis = fit.last
        values = {k: v for k, v in fit.values.items() if k not in axis.owned}
        for joint, sizes in _at_ends_of(axis, present.ordinary, fit.values).items():
            bearing = free.pop(joint, None)
            if bearing is not None:
                more = dict(zip(bearing.sizes, sizes, strict=True))
                found.append(_with_bearing(stage, present, bearing, values, more))
    return found


def taken_out(fit: Fit, gone: Instance) -> tuple[dict[str, float], Hypothesis]:
    """Return where a fit without an effect begins; bearings beside an axis take what it was."""
    rest = tuple(i for i in fit.hypothesis.instances if i is not gone)
    values = {k: v for k, v in fit.values.items() if k not in {p.name for p in gone.parameters}}
    ends = _at_ends_of(gone, fit.hypothesis.ordinary, fit.values)
    for bearing in rest:
        if bearing.effect.name == "bearing" and bearing.place in ends:
            for name, more in zip(bearing.sizes, ends[bearing.place], strict=True):
                values[name] += more
    return values, replace(fit.hypothesis, instances=rest)


def _at_ends_of(
    axis: Instance, ordinary: Ordinary, values: Mapping[str, float]
) -> dict[str, list[float]]:
    """What the bearings at both ends of its link would have of an axis, by joint: two sizes."""
    if axis.effect.name != "link_axis" or axis.describe is None:
        return {}
    joints = ordinary.arm.joints
    link = next(i for i, joint in enumerate(joints) if joint.link.name == axis.place)
    direction = np.asarray(axis.describe(values)["direction"])
    found = {}
    for joint in joints[link : link + 2]:
        is_own = joint is joints[link]
        own = direction if is_own else joint.T_parent_joint[:3, :3].T @ direction
        parts = (own @ across(np.asarray(joint.axis))) ** 2
        found[joint.name] = (values[axis.size] * parts).tolist()
    return found


def every_bearing(stage: Stage, fit: Fit, but: Sequence[tuple[str, str]]) -> list[Fit]:
    """Bearings of all joints, from the fit: what their own loss brings no linear look has seen."""
    return [
        _with_bearing(stage, fit.hypothesis, bearing, fit.values, {})
        for bearing in _bearings(fit.hypothesis).values()
        if bearing.key not in but
    ]


def _bearings(present: Hypothesis) -> dict[str, Instance]:
    taken = {instance.key for instance in present.instances}
    every = all_instances(present.ordinary)
    return {i.place: i for i in every if i.effect.name == "bearing" and i.key not in taken}


def _with_bearing(
    stage: Stage,
    present: Hypothesis,
    bearing: Instance,
    values: dict[str, float],
    more: dict[str, float],
) -> Fit:
    begin = {**values, **{name: values.get(name, 0.0) + own for name, own in more.items()}}
    richer = replace(present, instances=(*present.instances, bearing))
    return _quickly(stage, richer, begin, _BEARING_STEPS)


def split_axes(stage: Stage, fits: Sequence[Fit], steps: int) -> list[Fit]:
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
            found.append(fit_hypothesis(stage, richer, start=start, max_iterations=steps))
    return found


def spread_axes(stage: Stage, fits: Sequence[Fit], steps: int) -> list[Fit]:
    """An axis in a long link may stand for a link that gives way all along."""
    found = []
    for fit in fits:
        *others, axis = fit.hypothesis.instances
        spread = spread_of(axis, fit)
        if spread is not None:
            richer = replace(fit.hypothesis, instances=(*others, spread[0]))
            found.append(fit_hypothesis(stage, richer, start=spread[1], max_iterations=steps))
    return found


def spread_of(axis: Instance, fit: Fit) -> tuple[Instance, dict[str, float]] | None:
    """What twists or bends a long link all along instead of about an axis in it; a start."""
    ordinary = fit.hypothesis.ordinary
    line = next((own for own in long_links(ordinary) if own.name == axis.place), None)
    if axis.effect.name != "link_axis" or axis.describe is None or line is None:
        return None
    direction = np.asarray(axis.describe(fit.values)["direction"])
    kind = "link_torsion" if abs(direction @ line.along) > _ALONG else "link_bending"
    spread = next(
        i for i in all_instances(ordinary) if (i.effect.name, i.place) == (kind, line.name)
    )
    others = [other for other in fit.hypothesis.instances if other is not axis]
    if any(other.key == spread.key or spread.excludes(other) for other in others):
        return None
    start = {k: v for k, v in fit.values.items() if k not in axis.owned}
    return spread, {**start, spread.size: fit.values[axis.size] / line.length_m}
