"""Where in the arm the motion departs from the model: a linear look at every line of every link.

A rotation about any line of a link's interface is a combination t of its six freedoms, and its
column is quadratic in t,

    dy(t) = sum_ab t_a t_b (o w_a)(w_b b) ,

so that 21 columns an interface tell the gain of every line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects.compliance import compliance_parameter
from armodal.analyzer.gap.inference.fit import Fit, Stage
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter
from armodal.analyzer.gap.model.weighed_sums import summed
from armodal.protocols.arrays import frozen_array

__all__ = ["PAIRS", "Line", "best_lines", "left_after", "lines_of_interfaces"]

Array = npt.NDArray[np.float64]

_KEPT = 2  # lines of each link's interface
_APART = 0.7  # cosine of two lines' directions, below which they are
_N_DIRECTIONS = 60
_LEVERS_M = (0.1, 0.25)  # and none
PAIRS = [(a, b) for a in range(6) for b in range(a, 6)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """A line of a link's frame about which a turn, or along which a pull, would explain much."""

    link: int
    direction: Array  # (3,)
    point_m: Array  # (3,) nearest to the link's origin
    gain: float  # of cost, linear
    size: float  # that a linear look makes of it, of its prior's deviation


def lines_of_interfaces(stage: Stage, fit: Fit, *, exclude: Sequence[str] = ()) -> list[Line]:
    """Return the most promising lines of every link's interface, best first.

    `exclude` names links that are not looked at.
    """
    ordinary = fit.hypothesis.ordinary
    links = [i for i, joint in enumerate(ordinary.arm.joints) if joint.link.name not in exclude]
    found: list[Line] = []
    for link, (gram, slope) in zip(links, _interface_products(stage, fit, links), strict=True):
        found += best_lines(gram, slope, ordinary, link)
    return sorted(found, key=lambda line: -line.gain)


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
    size = n + len(links) * len(PAIRS)
    # All at once: they are locked, so that none changes what another answers.
    instances = (*fit.hypothesis.instances, *(probe for probe, _ in probes))
    wide = replace(fit.hypothesis, instances=instances)
    values = {**fit.values, **{name: 0.0 for _, names in probes for name in names}}
    gradient, curvature = np.zeros(size), np.zeros((size, size))
    for pairs, together in stage.once(fit.hypothesis, range(len(stage.lines))):
        y, columns = together.columns(fit.hypothesis, fit.space, fit.values)
        rows = [
            std * together.interface_columns(wide, values, names, PAIRS)
            for (_, names), std in zip(probes, stds, strict=True)
        ]
        own_lines, at = zip(*pairs, strict=True)
        weighings = [stage.weighings[p] for p in own_lines]
        part, _ = summed(weighings, y, columns.beside(np.concatenate(rows)), at)
        gradient += part.gradient
        curvature += part.curvature
    return left_after(fit, gradient, curvature)


def left_after(fit: Fit, gradient: Array, curvature: Array) -> list[tuple[Array, Array]]:
    """Gram matrix (21, 21) and slope (21,) of each 21 columns after a fit's own have followed."""
    free = np.flatnonzero(fit.free)
    A = curvature[np.ix_(free, free)] + np.eye(len(free))
    left = gradient[free] + fit.u[free]
    found = []
    for first in range(len(fit.space), len(gradient), len(PAIRS)):
        own = np.arange(first, first + len(PAIRS))
        B = curvature[np.ix_(free, own)]
        solved = np.linalg.solve(A, np.column_stack([B, left]))
        gram = curvature[np.ix_(own, own)] - B.T @ solved[:, :-1]
        found.append((gram, gradient[own] - B.T @ solved[:, -1]))
    return found


def best_lines(
    gram: Array, slope: Array, ordinary: Ordinary, link: int, *, travels: bool = False
) -> list[Line]:
    """Lines by falling gain, each well apart from the better ones.

    `travels`: along them, not about them.
    """
    q, lines = _lines_tried(tuple(ordinary.arm.joints[link].link.center_m.tolist()), travels)
    g = q @ slope
    h = np.einsum("ki,ij,kj->k", q, gram, q) + 1.0
    gain = np.where(g < 0.0, 0.5 * g * g / h, 0.0)
    chosen: list[int] = []
    for i in np.argsort(-gain):
        if all(abs(lines[i][0] @ lines[j][0]) < _APART for j in chosen):
            chosen.append(int(i))
        if len(chosen) == _KEPT:
            break
    return [
        Line(
            link=link,
            direction=lines[i][0],
            point_m=lines[i][1],
            gain=float(gain[i]),
            size=float(-g[i] / h[i]),
        )
        for i in chosen
    ]


@lru_cache(maxsize=64)
def _lines_tried(
    center: tuple[float, ...], travels: bool
) -> tuple[Array, list[tuple[Array, Array]]]:
    """Products (n_lines, 21) of lines' twists, and direction and nearest point of each.

    Through the link's origin and its centre (in its frame), and beside both.
    """
    u = _hemisphere(_N_DIRECTIONS)
    a, b = np.moveaxis(np.array([across(direction) for direction in u]), -1, 0)
    off = [np.zeros_like(u), *(lever * turn for lever in _LEVERS_M for turn in (a, b, -a, -b))]
    points = np.array([around + move for around in (np.zeros(3), np.array(center)) for move in off])
    points = (points - u * np.sum(u * points, axis=-1, keepdims=True)).swapaxes(0, 1)
    u = np.broadcast_to(u[:, None], points.shape)
    turn_and_lever = [np.cross(points, u), u]
    t = np.concatenate(turn_and_lever[:: -1 if travels else 1], axis=-1).reshape(-1, 6)
    lines = list(zip(u.reshape(-1, 3), points.reshape(-1, 3), strict=True))
    q = [t[:, a] * t[:, b] * (1.0 if a == b else 2.0) for a, b in PAIRS]
    return frozen_array(np.stack(q, axis=1), np.float64), lines


def _hemisphere(n: int) -> Array:
    """About evenly spread directions, one of each opposite pair: (n, 3)."""
    i = np.arange(n) + 0.5
    z = 1.0 - i / n
    turn = np.pi * (1.0 + np.sqrt(5.0)) * i
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=1)
