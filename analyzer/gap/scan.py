"""Which effects could explain what the present hypothesis does not: a linear look at all of them.

About the present best point every effect is a few more columns beside the ordinary ones. The gain
of an effect is what those columns take off the cost after the ordinary parameters have moved too,
priors and signs included. A line in a link has direction and place; a rotation about any line of
an interface is a combination t of its six freedoms, and its column is quadratic in t,

    dy(t) = sum_ab t_a t_b (o w_a)(w_b b) ,

so that 21 columns an interface tell the gain of every line.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.assembly import Assembly
from armodal.analyzer.gap.effects import link_axis
from armodal.analyzer.gap.effects.compliance import compliance_parameter
from armodal.analyzer.gap.effects.effect import EffectWords, Instance
from armodal.analyzer.gap.fit import Fit, Stage
from armodal.analyzer.gap.geometry import across
from armodal.analyzer.gap.ordinary import Ordinary
from armodal.analyzer.gap.space import Parameter, Space
from armodal.analyzer.gap.weigh import summed
from armodal.protocols.arrays import frozen_array

__all__ = ["Candidate", "scan_axes", "scan_instances"]

Array = npt.NDArray[np.float64]

_KEPT = 2  # lines of each link's interface
_N_DIRECTIONS = 60
_LEVERS_M = (0.0, 0.1, 0.25)
_PAIRS = [(a, b) for a in range(6) for b in range(a, 6)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """An instance, and what it promises."""

    instance: Instance
    gain: float  # of cost, linear
    size: float = float("nan")  # what a linear look makes of its size parameter
    size_std: float = float("nan")
    begin: Mapping[str, float] = field(default_factory=dict)  # values a fit begins with
    # What each ordinary parameter does, in its own unit, per unit of the size.
    follow: Mapping[str, float] = field(default_factory=dict)


def scan_instances(stage: Stage, fit: Fit, instances: Sequence[Instance]) -> list[Candidate]:
    """Linear gain of every instance on top of a fit, best first."""
    space, gradient, curvature = _wide(stage, fit, instances)
    ordinary = np.array([p.name in fit.space.index for p in space.parameters])
    free = np.flatnonzero(ordinary)[fit.free]
    left = gradient[free] + fit.u[fit.free]  # where the fit has not converged
    found = []
    for instance in instances:
        if not instance.parameters or instance.relaxes:
            found.append(_relaxed(fit, instance))
            continue
        names = [p.name for p in instance.parameters]
        own = np.array([space.index[n] for n in names])
        sizes = (instance.size, *instance.sizes)
        one_sided = np.array([p.low >= 0.0 and p.name in sizes for p in instance.parameters])
        gain, step, stds, follow, along = _gain(gradient, curvature, free, own, one_sided, left)
        at = names.index(instance.size)
        unit = space.std[own]
        reached = dict(zip(names, (space.mean[own] + step * unit).tolist(), strict=True))
        u = np.clip(fit.u[fit.free] + follow, fit.space.low[fit.free], fit.space.high[fit.free])
        moved = fit.u.copy()
        moved[fit.free] = u
        found.append(
            Candidate(
                instance=instance,
                gain=gain,
                size=float(step[at] * unit[at]),
                size_std=float(stds[at] * unit[at]),
                begin={**fit.space.values(moved), **reached},
                follow=dict(
                    zip(
                        np.array(list(fit.space.index))[fit.free].tolist(),
                        (along[:, at] * fit.space.std[fit.free] / unit[at]).tolist(),
                        strict=True,
                    )
                ),
            )
        )
    return sorted(found, key=lambda c: -c.gain)


def _wide(stage: Stage, fit: Fit, instances: Sequence[Instance]) -> tuple[Space, Array, Array]:
    """Space, gradient and curvature of a fit's hypothesis with all of the instances at no size."""
    new = [_small(i) for i in instances if i.parameters and not i.relaxes]
    wide = replace(fit.hypothesis, instances=(*fit.hypothesis.instances, *new))
    space = wide.space()
    values = {**{p.name: p.first for p in space.parameters}, **fit.values}
    whole, _ = stage.whole_quadratic(wide, space, values, range(len(stage.lines)))
    return space, whole.gradient, whole.curvature


def scan_axes(stage: Stage, fit: Fit, *, exclude: Sequence[str] = ()) -> list[Candidate]:
    """The most promising lines of every link's interface, best first."""
    ordinary = fit.hypothesis.ordinary
    links = [i for i, joint in enumerate(ordinary.arm.joints) if joint.link.name not in exclude]
    found: list[Candidate] = []
    for link, (gram, slope) in zip(links, _interface_products(stage, fit, links), strict=True):
        gains, lines = _best_lines(gram, slope, ordinary, link)
        for gain, (direction, point) in list(zip(gains, lines, strict=True))[:_KEPT]:
            instance = link_axis.at_axis(ordinary, link, direction, point)
            found.append(Candidate(instance=instance, gain=gain))
    return sorted(found, key=lambda c: -c.gain)


def _small(instance: Instance) -> Instance:
    """The instance with its size at zero, so that it changes nothing yet."""
    if not instance.size or instance.size_offset:
        return instance
    parameters = tuple(
        replace(p, start=0.0) if p.name in (instance.size, *instance.sizes) else p
        for p in instance.parameters
    )
    return replace(instance, parameters=parameters)


def _gain(
    gradient: Array,
    curvature: Array,
    free: npt.NDArray[np.int64],
    own: npt.NDArray[np.int64],
    one_sided: npt.NDArray[np.bool_],
    left: Array,
) -> tuple[float, Array, Array, Array, Array]:
    """Cost that the own columns take off when the free ones follow; one-sided ones only grow.

    `left` (n_free,) is the free ones' slope: what they gain without the own ones does not count.

    Returns the gain, the step (n_own,), its standard deviation, each alone, how the free ones
    follow (n_free,), and how they do per unit of each (n_free, n_own).
    """
    A = curvature[np.ix_(free, free)] + np.eye(len(free))
    B = curvature[np.ix_(free, own)]
    along = np.linalg.solve(A, B)
    S = curvature[np.ix_(own, own)] + np.eye(len(own)) - B.T @ along
    own_way = np.linalg.solve(A, left)
    slope = gradient[own] - B.T @ own_way
    std: Array = 1.0 / np.sqrt(S.diagonal())
    active = ~(one_sided & (slope >= 0.0))
    whole: Array = np.zeros(len(own))
    for _ in range(3):
        if not active.any():
            break
        step = -np.linalg.solve(S[np.ix_(active, active)], slope[active])
        wrong = one_sided[active] & (step < 0.0)
        if not wrong.any():
            whole[active] = step
            gain = -0.5 * float(step @ slope[active])
            follow: Array = np.asarray(-along @ whole - own_way)
            return gain, whole, std, follow, np.asarray(-along)
        active[np.flatnonzero(active)[wrong]] = False
    return 0.0, whole, std, np.asarray(-own_way), np.asarray(-along)


def _relaxed(fit: Fit, instance: Instance) -> Candidate:
    """What is gained when priors become wide; size, its deviation, what follows it.

    The fit's own slope, where it has not converged or rests at a limit, counts with both priors.
    """
    A = fit.curvature + np.eye(len(fit.u))
    wide, slope = A.copy(), fit.slope.copy()
    free = fit.free.copy()
    gain = 0.0
    for name, prior in instance.relaxes.items():
        i = fit.space.index[name]
        narrow = fit.space.std[i]
        keep = (narrow / prior.std) ** 2
        u = fit.u[i] + (fit.space.mean[i] - prior.mean) / narrow
        wide[i, i] += keep - 1.0
        slope[i] += keep * u - fit.u[i]
        free[i] = True
        gain += 0.5 * (fit.u[i] ** 2 - keep * u**2)
    was = np.flatnonzero(fit.free)
    gain -= 0.5 * float(fit.slope[was] @ np.linalg.solve(A[np.ix_(was, was)], fit.slope[was]))
    now = np.flatnonzero(free)
    inverse = np.linalg.inv(wide[np.ix_(now, now)])
    step = -inverse @ slope[now]
    gain -= 0.5 * float(step @ slope[now])
    if instance.size not in fit.space.index:
        return Candidate(instance=instance, gain=gain)
    i = fit.space.index[instance.size]
    at = int(np.flatnonzero(now == i)[0])
    unit = float(fit.space.std[i])
    follow = inverse[:, at] / inverse[at, at] * fit.space.std[now] / unit
    names = np.array(list(fit.space.index))[now].tolist()
    return Candidate(
        instance=instance,
        gain=gain,
        size=float(fit.space.mean[i]) + unit * float(fit.u[i] + step[at]),
        size_std=unit * float(np.sqrt(inverse[at, at])),
        follow=dict(zip(names, follow.tolist(), strict=True)),
    )


def _probe(ordinary: Ordinary, link: int) -> tuple[Instance, list[str]]:
    """All six freedoms of an interface, locked."""
    columns = ordinary.superset.interface_columns(link)
    names = [f"probe {a} {link}" for a in range(6)]

    def build(assembly: Assembly, values: object) -> None:
        del values
        for a, name in enumerate(names):
            assembly.add_compliance(assembly.unit(columns.start + a), 0.0, 0.0, name)

    words = EffectWords(name="probe", title="probe", changes="", signature="")
    parameters = tuple(
        Parameter(
            name=name,
            unit="rad/(N m)",
            mean=0.0,
            std=compliance_parameter("", ordinary, link).std,
        )
        for name in names
    )
    return Instance(effect=words, place="", parameters=parameters, builder=build), names


def _interface_products(stage: Stage, fit: Fit, links: Sequence[int]) -> list[tuple[Array, Array]]:
    """Projected Gram matrix (21, 21) and slope (21,) of each interface's columns."""
    ordinary = fit.hypothesis.ordinary
    stds = [compliance_parameter("", ordinary, link).std for link in links]
    probes = [_probe(ordinary, link) for link in links]
    n = len(fit.space)
    size = n + len(links) * len(_PAIRS)
    gradient, curvature = np.zeros(size), np.zeros((size, size))
    for pairs, together in stage.once(fit.hypothesis, range(len(stage.lines))):
        y, dy = together.derivatives(fit.hypothesis, fit.space, fit.values)
        rows = [dy]
        for (probe, names), std in zip(probes, stds, strict=True):
            wide = replace(fit.hypothesis, instances=(*fit.hypothesis.instances, probe))
            values = {**fit.values, **dict.fromkeys(names, 0.0)}
            rows.append(std * together.interface_columns(wide, values, names, _PAIRS))
        own_lines, at = zip(*pairs, strict=True)
        weighings = [stage.weighings[p] for p in own_lines]
        part, _ = summed(weighings, y, np.concatenate(rows), at)
        gradient += part.gradient
        curvature += part.curvature
    free = np.flatnonzero(fit.free)
    A = curvature[np.ix_(free, free)] + np.eye(len(free))
    left = gradient[free] + fit.u[free]
    found = []
    for i in range(len(links)):
        own = np.arange(n + i * len(_PAIRS), n + (i + 1) * len(_PAIRS))
        B = curvature[np.ix_(free, own)]
        solved = np.linalg.solve(A, np.column_stack([B, left]))
        gram = curvature[np.ix_(own, own)] - B.T @ solved[:, :-1]
        found.append((gram, gradient[own] - B.T @ solved[:, -1]))
    return found


def _best_lines(
    gram: Array, slope: Array, ordinary: Ordinary, link: int
) -> tuple[list[float], list[tuple[Array, Array]]]:
    """Lines by falling gain, each well apart from the better ones."""
    q, lines = _lines_tried(tuple(ordinary.arm.joints[link].link.center_m.tolist()))
    g = q @ slope
    h = np.einsum("ki,ij,kj->k", q, gram, q) + 1.0
    gain = np.where(g < 0.0, 0.5 * g * g / h, 0.0)
    chosen: list[int] = []
    for i in np.argsort(-gain):
        if all(abs(lines[i][0] @ lines[j][0]) < 0.7 for j in chosen):
            chosen.append(int(i))
        if len(chosen) == 3:
            break
    return [float(gain[i]) for i in chosen], [lines[i] for i in chosen]


@lru_cache(maxsize=64)
def _lines_tried(center: tuple[float, ...]) -> tuple[Array, list[tuple[Array, Array]]]:
    """Products (n_lines, 21) of lines' twists, and direction and nearest point of each.

    Through the link's origin and its centre (in its frame), and beside both.
    """
    twists, lines = [], []
    for u in _hemisphere(_N_DIRECTIONS):
        a, b = across(u).T
        for around in (np.zeros(3), np.array(center)):
            for lever in _LEVERS_M:
                for turn in (a, b, -a, -b) if lever else (a,):
                    point = around + lever * turn
                    point = point - u * (u @ point)
                    twists.append(np.concatenate([np.cross(point, u), u]))
                    lines.append((u, point))
    t = np.array(twists)
    q = [t[:, a] * t[:, b] * (1.0 if a == b else 2.0) for a, b in _PAIRS]
    return frozen_array(np.stack(q, axis=1), np.float64), lines


def _hemisphere(n: int) -> Array:
    """About evenly spread directions, one of each opposite pair: (n, 3)."""
    i = np.arange(n) + 0.5
    z = 1.0 - i / n
    turn = np.pi * (1.0 + np.sqrt(5.0)) * i
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=1)
