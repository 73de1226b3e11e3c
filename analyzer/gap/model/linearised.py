"""A joint's own law in a linear model: what of it is no spring and no damper is carried beside.

About one point every posture's hits of a level are followed step by step (`swings.py`). A spring
and a damper that do nearly the same (least squares over all of those swings, as the lines weigh
them) take the law's place in the equations, so that whatever else moves answers as it should; what
they leave of the response is added, as is what each of the law's parameters changes in it. So the
prediction is exact at the point and linear in the law's parameters about it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.hysteresis import lost_by_power, relaxed
from armodal.analyzer.gap.model.assembly import Assembly, relaxing_name
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.geometry import PostureGeometry
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.joint_laws import (
    JointLaw,
    Linearised,
    LinearLaw,
    added_logs,
    stacked,
)
from armodal.analyzer.gap.model.law_beside import with_all_slopes
from armodal.analyzer.gap.model.law_in_place import (
    joint_row,
    on_lines,
    with_a_torque,
    with_springs,
)
from armodal.analyzer.gap.model.law_steps import own_spring, slope_of, steps_of
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.march import march
from armodal.analyzer.gap.model.posed import PosedModel, Postures
from armodal.analyzer.gap.model.steps import STEPS
from armodal.analyzer.gap.model.swings import (
    SIGMA_RAD_S,
    Swings,
    forces_of,
    free_turns,
    points,
    turns_of,
)
from armodal.analyzer.gap.model.systems import systems

__all__ = [
    "JointPosture",
    "joint_postures",
    "linearised",
    "linearised_about_each",
    "linearised_near",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_ENDLESS = "swings under this law do not stay finite"
_TO_THE_MIDDLE = 2  # a law is of its joint's spring, which then is another


@dataclass(frozen=True, slots=True, kw_only=True)
class JointPosture:
    """One posture's joints."""

    swings: Sequence[Swings]
    geometry: PostureGeometry
    resists: Mapping[str, ComplexArray]  # (M,) of each, over its stiffness (`swings.points`)
    values: Mapping[str, float]  # of the model

    def at(self, values: Mapping[str, float], joint: str) -> JointPosture:
        """Return the one joint with its own spring and damper as values have them."""
        old, new = (
            [float(np.exp(own[f"ln {what} {joint}"])) for what in "kc"]
            for own in (self.values, values)
        )
        (swings,) = self.swings
        there = swings.stiffer(new[0] - old[0], new[1] - old[1], self.resists[joint])
        return replace(self, swings=(there,), values=values)


_Case = tuple[Mapping[str, JointPosture], Sequence[Mapping[str, float]]]  # postures, values
_Swung = list[tuple[Array, Array]]  # turns and torques on each of the lines


def linearised(
    hypothesis: Hypothesis,
    models: Sequence[PosedModel],
    lines: Sequence[PostureLines],
    values: Mapping[str, float],
    *,
    last: bool = False,
    slopes: bool = True,
) -> Hypothesis:
    """Return the hypothesis with its joints' own laws linearised about values, on some lines.

    Parameters
    ----------
    last
        The last instance anew; laws that are known on all of the lines stay where they are.
    slopes
        Else a law is known at that point alone.

    Raises
    ------
    numpy.linalg.LinAlgError
        If swings under a law do not stay finite there.
    """
    ends = hypothesis.instances[-1]
    wanted = [
        i.law is not None and ((last and i is ends) or not _covers(i, lines))
        for i in hypothesis.instances
    ]
    if not any(wanted):
        return hypothesis
    plain = replace(hypothesis, instances=tuple(i for i in hypothesis.instances if i.law is None))
    about = tuple(
        replace(i, about=_about(plain, i, models, lines, values, slopes=slopes)) if anew else i
        for i, anew in zip(hypothesis.instances, wanted, strict=True)
    )
    return replace(hypothesis, instances=about)


def linearised_near(
    hypothesis: Hypothesis,
    models: Sequence[PosedModel],
    lines: Sequence[PostureLines],
    values: Mapping[str, float],
) -> Hypothesis:
    """Return it with its last law exact at values, its slopes those of where it was linearised.

    A tenth of the work of new slopes, and near there they are nearly the same.

    Raises
    ------
    numpy.linalg.LinAlgError
        If swings under the law do not stay finite there.
    """
    *others, last = hypothesis.instances
    law, about = last.law, last.about
    if law is None or about is None:
        raise ValueError(f"wanted a law that is linearised of {last.title}")
    plain = replace(hypothesis, instances=tuple(i for i in hypothesis.instances if i.law is None))
    postures = joint_postures(plain, models, lines, values, (law.joint,))
    (followed,) = _followed(law, [(postures, [values])], lines)
    if not _finite(followed):
        raise np.linalg.LinAlgError(_ENDLESS)
    groups = Postures.in_groups(models, lines, range(len(lines)))
    springs = {key: (own.log_k, own.log_c) for key, own in about.table.items()}
    exact = _beside(plain, law, groups, lines, values, followed, {}, springs)
    table = {key: replace(own, by=about.table[key].by) for key, own in exact.table.items()}
    there = Linearised(values={name: values[name] for name in about.values}, table=table)
    return replace(hypothesis, instances=(*others, replace(last, about=there)))


def _covers(instance: Instance, lines: Sequence[PostureLines]) -> bool:
    return all(instance.linear_law(own) is not None for own in lines)


def _about(
    plain: Hypothesis,
    instance: Instance,
    models: Sequence[PosedModel],
    lines: Sequence[PostureLines],
    values: Mapping[str, float],
    *,
    slopes: bool,
) -> Linearised:
    law = instance.law
    if law is None:
        raise ValueError(f"wanted a law of {instance.title}")
    parameters = instance.parameters if slopes else ()
    steps = {parameter.name: steps_of(values, parameter) for parameter in parameters}
    points = [dict(values), *(end for ends in steps.values() for end in ends)]
    postures = joint_postures(plain, models, lines, values, (law.joint,))
    cases: list[_Case] = [(postures, points)]
    # A law acts on its joint's own spring and damper: what it leaves of a column of either is a
    # difference of large ones, and taken from swings as well.
    own = own_spring(plain, law.joint) if slopes else ()
    own_steps = {parameter.name: steps_of(values, parameter) for parameter in own}
    for end in (end for ends in own_steps.values() for end in ends):
        at_it = {name: posture.at(end, law.joint) for name, posture in postures.items()}
        cases.append((at_it, [end]))
    groups = Postures.in_groups(models, lines, range(len(lines)))
    followed, *beside = _followed(law, cases, lines)
    if not all(_finite(swung) for swung in (followed, *beside)):
        raise np.linalg.LinAlgError(_ENDLESS)
    per_unit = {name: 1.0 / (ends[1][name] - ends[0][name]) for name, ends in steps.items()}
    about = _beside(plain, law, groups, lines, values, followed, per_unit)
    if not slopes:
        return about
    by_steps = {name: posture.swings[0].by_steps for name, posture in postures.items()}
    own_slopes = {
        name: slope_of(plain, law.joint, groups, lines, name, ends, (back, on))
        for (name, ends), back, on in zip(own_steps.items(), beside[::2], beside[1::2], strict=True)
    }
    return with_all_slopes(
        about, plain, law, groups, models, lines, values, by_steps, followed, own_slopes
    )


def joint_postures(
    plain: Hypothesis,
    models: Sequence[PosedModel],
    lines: Sequence[PostureLines],
    values: Mapping[str, float],
    joints: Sequence[str],
) -> dict[str, JointPosture]:
    """By its name, each posture's joints as a model without laws foretells them."""
    found: dict[str, JointPosture] = {}
    for model, own in zip(models, lines, strict=True):
        if own.name in found:
            continue
        assembly = Postures([model], [own]).assembled(plain, values)[0]
        system = systems([assembly])
        rows = [joint_row(assembly, joint) for joint in joints]
        found[own.name] = JointPosture(
            swings=turns_of(system, rows),
            geometry=assembly.geometry,
            resists={joint: _resists(assembly, values, joint) for joint in joints},
            values=values,
        )
    return found


def _resists(assembly: Assembly, values: Mapping[str, float], joint: str) -> ComplexArray:
    s = points().s_rad_s
    power, rate = assembly.loss_power, assembly.relaxing_rad_s[relaxing_name(joint)]
    lost = values[f"loss {joint}"] * lost_by_power(s, np.array(power))
    return np.asarray(1.0 + lost + values[relaxing_name(joint)] * relaxed(s, np.array(rate)))


def _followed(law: JointLaw, cases: Sequence[_Case], lines: Sequence[PostureLines]) -> list[_Swung]:
    """Turns and torques (points, m, n_steps) of each of the lines' mountings, in each of the cases.

    All at once: a step in time takes as long for one swing as for hundreds. What does not stay
    finite is told as it is.
    """
    names = list(cases[0][0])
    order = sorted(range(len(lines)), key=lambda p: names.index(lines[p].name))
    by_steps: list[Array] = []
    free, groups, elements, counts = [], [], [], []
    for postures, every in cases:
        before = len(by_steps)
        by_steps += [postures[name].swings[0].by_steps for name in names]
        for p in order:
            own, posture = lines[p], postures[lines[p].name]
            turns = free_turns(posture.swings[0], own.hit, forces_of(own.peaks_n, own.width_s))
            for point in every:
                free.append(turns)
                elements.append(law.element(point, law.load_n_m(posture.geometry, own.known_mass)))
                counts.append(len(turns))
            groups += [before + names.index(own.name)] * len(turns) * len(every)
    with np.errstate(over="ignore", invalid="ignore"):
        turns, torques = march(
            np.stack(by_steps), np.array(groups), np.concatenate(free), stacked(elements, counts)
        )
    swung: list[_Swung] = []
    begin = 0
    for _, every in cases:
        found: dict[int, tuple[Array, Array]] = {}
        for p in order:
            m = len(lines[p].peaks_n)
            end = begin + m * len(every)
            shape = (len(every), m, -1)
            found[p] = turns[begin:end].reshape(shape), torques[begin:end].reshape(shape)
            begin = end
        swung.append([found[p] for p in range(len(lines))])
    return swung


def _finite(swung: _Swung) -> bool:
    return all(bool(np.isfinite(torque).all()) for _, torque in swung)


def _beside(
    plain: Hypothesis,
    law: JointLaw,
    groups: Sequence[tuple[list[int], Postures]],
    lines: Sequence[PostureLines],
    values: Mapping[str, float],
    followed: Sequence[tuple[Array, Array]],
    slopes: Mapping[str, float],
    springs: Mapping[tuple[object, ...], tuple[float, float]] | None = None,
) -> Linearised:
    """Springs and dampers in the law's place, and what is added to their response.

    `springs`: what they add to ln k and ln c, by the lines' key; else those nearest to the law.
    """
    joint = law.joint
    if springs is None:
        keys = [own.key for own in lines]
        springs = dict(zip(keys, _in_place(law, values, followed), strict=True))
    near = with_springs(plain, joint, springs)
    nearly = {
        p: response
        for used, together in groups
        for p, response in zip(used, together.response(near, values).values, strict=True)
    }
    table = {}
    for p, (plainly, load) in with_a_torque(plain, joint, groups, values).items():
        own = lines[p]
        taken = on_lines(own, followed[p][1])  # (points, m, L)
        change = -load * taken[:, :, None]  # (points, m, 3, L)
        ends = zip(slopes.items(), change[1::2], change[2::2], strict=True)
        table[own.key] = LinearLaw(
            log_k=springs[own.key][0],
            log_c=springs[own.key][1],
            added=plainly + change[0] - nearly[p],
            by={name: (on - back) * slope for (name, slope), back, on in ends},
        )
    return Linearised(values={name: values[name] for name in slopes}, table=table)


def _in_place(
    law: JointLaw, values: Mapping[str, float], followed: Sequence[tuple[Array, Array]]
) -> list[tuple[float, float]]:
    """What a spring and a damper in a law's place add to ln k and ln c, on each of the lines."""
    return [
        added_logs(law, values, *_spring_and_damper(turn[0], torque[0]))
        for turn, torque in followed
    ]


def linearised_about_each(
    hypothesis: Hypothesis,
    models: Sequence[PosedModel],
    lines: Sequence[PostureLines],
    near: Mapping[str, JointPosture],
    starting_points: Sequence[Mapping[str, float]],
) -> list[tuple[Hypothesis, dict[str, float]]]:
    """The last instance's law about each of several values, known at that point alone.

    At each the joint's k and c are such that, with its law, they are on average over the lines
    what they were.

    Parameters
    ----------
    near
        Postures of the model without the law.

    Returns
    -------
    Each hypothesis with its values; without those under which swings do not stay finite.
    """
    law = hypothesis.instances[-1].law
    if law is None:
        raise ValueError(f"wanted a law of {hypothesis.instances[-1].title}")
    names = [f"ln {what} {law.joint}" for what in "kc"]
    every = [(np.array([own[name] for name in names]), dict(own)) for own in starting_points]
    for turn in range(_TO_THE_MIDDLE + 1):
        cases: list[_Case] = [
            ({name: own.at(values, law.joint) for name, own in near.items()}, [values])
            for _, values in every
        ]
        swung = _followed(law, cases, lines) if cases else []
        stays = [_finite(own) for own in swung]
        every = [own for own, fine in zip(every, stays, strict=True) if fine]
        swung = [own for own, fine in zip(swung, stays, strict=True) if fine]
        if turn == _TO_THE_MIDDLE:
            break
        for (wanted, values), own in zip(every, swung, strict=True):
            added = np.mean(_in_place(law, values, own), axis=0)
            values |= dict(zip(names, (wanted - added).tolist(), strict=True))
    plain = replace(hypothesis, instances=tuple(i for i in hypothesis.instances if i.law is None))
    groups = Postures.in_groups(models, lines, range(len(lines)))
    *others, last = hypothesis.instances
    found = []
    for (_, values), own in zip(every, swung, strict=True):
        about = _beside(plain, law, groups, lines, values, own, {})
        instances = (*others, replace(last, about=about))
        found.append((replace(hypothesis, instances=instances), values))
    return found


def _spring_and_damper(turn: Array, torque: Array) -> tuple[float, float]:
    """N m/rad and N m s/rad nearest to torques (m, n_steps), late ones counting less."""
    window = np.sqrt(STEPS.weights_s) * np.exp(-SIGMA_RAD_S * STEPS.seconds)
    rate = np.gradient(turn, STEPS.seconds, axis=1)
    basis = np.stack([(turn * window).ravel(), (rate * window).ravel()])
    k, c = np.linalg.lstsq(basis.T, (torque * window).ravel(), rcond=None)[0]
    return float(k), float(c)
