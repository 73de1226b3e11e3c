"""What a link that bends and one that twists have in common: a line, places where it gives way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analyzer.gap.assembly import Assembly
from analyzer.gap.effects.compliance import compliance_parameter, loss_parameter
from analyzer.gap.effects.effect import EffectWords, Instance
from analyzer.gap.ordinary import Ordinary

__all__ = ["LongLink", "given_way", "long_links"]

Array = npt.NDArray[np.float64]

_LEAST_M = 0.2  # shorter links are stiff
_SLICES = 3  # three hinges at 1/6, 1/2, 5/6 give a tip wrench's deflection to 3 %
_ROD = 0.7  # of a link's inertia across its line that its spread along the line makes


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
            (s, np.concatenate([np.cross(s * self.along, u), u]))
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

    Of the link's own mass only what is beyond a hinge moves with it, and points before it do not.
    """
    gamma, loss = f"{word} compliance {line.name}", f"{word} loss {line.name}"
    columns = ordinary.superset.interface_columns(line.link)
    part = line.length_m / _SLICES
    hinges = []
    points = [
        (i, float(point.position_m @ line.along))
        for i, point in enumerate(ordinary.arm.points)
        if ordinary.superset.point_link[i] == line.link
    ]
    for s, twist in line.twists(directions):
        column = np.zeros(ordinary.superset.n)
        column[columns] = twist
        still = np.array([i for i, at in points if at < s], dtype=np.int64)
        hinges.append((column, _of_own_mass(ordinary, line, s, twist[3:]), still))

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        for column, own, still in hinges:
            at = assembly.add_compliance(
                column, values[gamma], values[loss], gamma, loss, part=part
            )
            assembly.inside[at] = (line.link, own, still)

    return Instance(
        effect=words,
        place=line.name,
        parameters=(
            compliance_parameter(gamma, ordinary, scale=1.0 / line.length_m),
            loss_parameter(loss),
        ),
        builder=build,
        size=gamma,
        material=material * ordinary.compliance / line.length_m,
    )


def _of_own_mass(ordinary: Ordinary, line: LongLink, s: float, direction: Array) -> Array:
    """Twist (6,) of the whole link with the momentum of what lies beyond a hinge at s.

    The link's mass is taken as a rod along the line about the centre, as long as its inertia
    across the line says.
    """
    body = ordinary.arm.joints[line.link].link
    own = body.inertia_kg_m2
    across = 0.5 * float(np.trace(own) - line.along @ own @ line.along)
    half = float(np.sqrt(3.0 * _ROD * across / body.mass_kg))
    center = float(body.center_m @ line.along)
    start, end = center - half, center + half
    share = float(np.clip((end - s) / (2.0 * half), 0.0, 1.0))
    beyond = 0.5 * (end + np.clip(s, start, end))  # where its centre lies
    # share (beyond - s) is its first moment about the hinge; the link's is (center - place).
    off = body.center_m - center * line.along
    moved = share * np.cross(direction, off + (beyond - s) * line.along)
    turned = share * direction
    # The linear part is that of the link's origin.
    return np.concatenate([moved - np.cross(turned, body.center_m), turned])
