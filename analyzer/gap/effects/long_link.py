"""What a link that bends and one that twists have in common: a line, places where it gives way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.assembly import Assembly
from armodal.analyzer.gap.effects.compliance import compliance_parameter, loss_parameter
from armodal.analyzer.gap.effects.effect import EffectWords, Instance
from armodal.analyzer.gap.geometry import skew
from armodal.analyzer.gap.ordinary import Ordinary
from armodal.analyzer.gap.space import Parameter

__all__ = ["LongLink", "given_way", "long_links"]

Array = npt.NDArray[np.float64]

_LEAST_M = 0.2  # shorter links are stiff
_SLICES = 3  # three hinges at 1/6, 1/2, 5/6 give a tip wrench's deflection to 3 %
_START = 0.03  # of the size's deviation: from nothing a first step goes astray
_SPREAD, _SPREAD_STD = 0.6, 0.3  # of its length that a link's mass is spread over


@dataclass(frozen=True, slots=True, kw_only=True)
class LongLink:
    """A link along the line from its joint to the next, in its own frame."""

    link: int
    name: str
    along: Array  # (3,) unit
    length_m: float

    @property
    def places_m(self) -> tuple[float, ...]:
        """Return where along the line the hinges stand."""
        return tuple((i + 0.5) / _SLICES * self.length_m for i in range(_SLICES))

    def twists(self, directions: Sequence[Array]) -> list[tuple[float, Array]]:
        """Return place and unit twist (6,), linear first, of every hinge."""
        return [
            (s, np.concatenate([skew(s * self.along) @ u, u]))
            for s in self.places_m
            for u in directions
        ]


def long_links(ordinary: Ordinary) -> tuple[LongLink, ...]:
    """Return the links long enough to bend, with points at two places at least.

    The line goes to the next joint; where that stands at the link's own, to twice the centre.
    """
    found = []
    joints = ordinary.arm.joints
    for i, joint in enumerate(joints):
        if ordinary.superset.point_link.count(i) < 2:
            continue
        reach = np.zeros(3) if i + 1 == len(joints) else joints[i + 1].T_parent_joint[:3, 3]
        if np.linalg.norm(reach) < _LEAST_M / 4.0:
            reach = 2.0 * joint.link.center_m
        length = float(np.linalg.norm(reach))
        if length >= _LEAST_M:
            found.append(
                LongLink(link=i, name=joint.link.name, along=reach / length, length_m=length)
            )
    return tuple(found)


def given_way(
    ordinary: Ordinary,
    line: LongLink,
    directions: Sequence[Array],
    words: EffectWords,
    *,
    word: str,
    material: float,
) -> Instance:
    """A link whose compliance about each direction is spread over its length, 1/EI or 1/GJ.

    The link's mass is in pieces between the hinges, spread evenly over a part of its length about
    its centre; points go with the piece they stand on.
    """
    gamma, loss, spread = (
        f"{word} {what} {line.name}" for what in ("compliance", "loss", "spread")
    )
    columns = ordinary.superset.interface_columns(line.link)
    part = line.length_m / _SLICES
    hinges = []
    points = [
        (i, float(point.position_m @ line.along))
        for i, point in enumerate(ordinary.arm.points)
        if ordinary.superset.point_link[i] == line.link
    ]
    for number, (s, twist) in enumerate(line.twists(directions)):
        column = np.zeros(ordinary.superset.n)
        column[columns] = twist
        still = np.zeros(len(ordinary.arm.points), dtype=np.bool_)
        still[[i for i, at in points if at < s]] = True
        hinges.append((column, 1 + number // len(directions), still))
    edges = np.array([0.0, *line.places_m, line.length_m])
    shares = np.diff(edges) / line.length_m
    middles = 0.5 * (edges[1:] + edges[:-1]) - 0.5 * line.length_m

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        # A link that both bends and twists is in the same pieces.
        offsets = values[spread] * np.outer(middles, line.along)
        assembly.pieces.setdefault(line.link, (shares, offsets))
        for column, before, still in hinges:
            at = assembly.add_compliance(
                column, values[gamma], values[loss], gamma, loss, part=part
            )
            assembly.between[at] = (line.link, before, still)

    size = compliance_parameter(gamma, ordinary, line.link, length_m=line.length_m)

    def starts(values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        return [{**values, gamma: _START * size.std}]

    return Instance(
        effect=words,
        place=line.name,
        parameters=(
            size,
            loss_parameter(loss),
            Parameter(name=spread, unit="", mean=_SPREAD, std=_SPREAD_STD, low=0.0, high=1.0),
        ),
        builder=build,
        starts=starts,
        size=gamma,
        shapes=(spread,),
        pieces=f"hinges {line.name}",
        material=material * ordinary.scale(line.link) / line.length_m,
    )
