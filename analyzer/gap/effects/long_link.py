"""What a link that bends and one that twists have in common: a line, places where it gives way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects.compliance import compliance_parameter
from armodal.analyzer.gap.effects.hinges import hinges_along, parts_along, soft_places
from armodal.analyzer.gap.effects.link_axis import at_axis, splits
from armodal.analyzer.gap.effects.yielding_line import YieldingLine
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.interface import loss_factor_parameter, loss_parameter
from armodal.analyzer.gap.model.long_links import LongLink, long_links
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.priors import MASS_SPREAD
from armodal.analyzer.gap.model.soft_parts import place_parameter
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["given_way"]

Array = npt.NDArray[np.float64]

_SPREAD_STD = 0.3  # of the part of its length that a link's mass is spread over
# Where along it a link gives way: a stretch of it, any part of the length, even draws; and ln of
# the softness at its far end over that at its near one, and at its middle over that of its ends.
# A narrower stretch than the least is one place.
_STRETCH, _STRETCH_STD, _STRETCH_LEAST, _STRETCH_MOST = 0.5, 1.0 / np.sqrt(12.0), 0.02, 1.0
_TAPER_STD, _MIDDLE_STD = 1.9, 1.9
_START = 0.03  # of the size's deviation: from zero a first step misleads


def given_way(
    ordinary: Ordinary,
    line: LongLink,
    words: EffectWords,
    *,
    bends: bool,
    word: str,
    material: float,
) -> Instance:
    """A link whose compliance each way is spread over its length, 1/EI or 1/GJ.

    Castings taper, flanges stiffen their ends, or they are bolted together somewhere: how long a
    stretch of it is soft, where, and how much at its ends and between are parameters. So is where
    the line stands, and along which direction: drives and covers draw the centre of mass aside. One
    that bends does so more easily about one direction than about the other; its size is the mean of
    both. The link's mass is in pieces along it, spread evenly over a part of its length about its
    centre, as far as its own inertia allows; pieces and points turn with the stretch they stand on.
    """
    gamma, loss, factor, spread, *where = (
        f"{word} {what} {line.name}"
        for what in (
            *("compliance", "loss", "loss factor", "spread"),
            *("place", "stretch", "taper", "middle"),
        )
    )
    place, stretch, taper, middle = where
    yielding = YieldingLine(line=line, bends=bends, word=word)
    hinges = hinges_along(ordinary.superset, yielding, (place, stretch, taper, middle))
    body = ordinary.arm.joints[line.link].link

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        # A link that both bends and twists is in the same pieces.
        assembly.pieces.setdefault(line.link, line.pieces(body, values[spread]))
        for hinge in hinges(values):
            at = assembly.add_compliance(
                hinge.motion,
                values[gamma],
                values[loss],
                gamma,
                loss,
                part=hinge.part_m,
                part_slopes=hinge.part_slopes,
            )
            assembly.add_loss_factor([at], values[factor], factor)
            assembly.inside[at] = hinge.inside
            for name, moved in hinge.moved:
                assembly.motion_of.setdefault(name, []).append((at, moved))

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        """Ends and bow of the line, between which places of it it is soft, and about what most.

        In the link's frame; places are told from the line's first end.
        """
        start, end = yielding.ends(values)
        name = ordinary.arm.joints[line.link].link.name
        told: dict[str, object] = {"link": name, "from_m": start.tolist(), "to_m": end.tolist()}
        told["bow_m"] = yielding.bow_m(values).tolist()
        edges, _ = soft_places(values[place], values[stretch])
        told["soft_between_m"] = (line.length_m * edges[[0, -1]]).tolist()
        if bends:
            directions, yields = yielding.softest(values)
            told["softest_about"] = directions[:, 0].tolist()
            told["softest_over_stiffest"] = float(yields[0] / yields[1])
        return told

    def alternatives(
        values: Mapping[str, float],
    ) -> Sequence[tuple[Instance, Mapping[str, float]]]:
        """Another such link, as soft from end to end: beyond a joint in line both turn alike.

        Or an axis in this one, where it is softest, with its first points before it.
        """
        rest = {k: v for k, v in values.items() if k not in own}
        whole = values[gamma] * line.length_m
        edges, _ = soft_places(values[place], values[stretch])
        parts, _ = parts_along(values[taper], values[middle])
        at = float(parts @ (0.5 * (edges[1:] + edges[:-1])))
        start, end = yielding.ends(values)
        point_m = start + at * (end - start) + 4.0 * at * (1.0 - at) * yielding.bow_m(values)
        axes = [
            at_axis(ordinary, line.link, u, point_m, before=points)
            for u in yielding.softest(values)[0].T
            for points in splits(ordinary, line.link)
        ]
        return [(axis, rest | {axis.size: whole}) for axis in axes] + [
            (
                there := given_way(
                    ordinary, other, words, bends=bends, word=word, material=material
                ),
                rest | {there.size: whole / other.length_m},
            )
            for other in long_links(ordinary.superset)
            if abs(other.link - line.link) == 1
        ]

    shapes = (spread, *where, *(p.name for p in yielding.parameters))
    own = {gamma, loss, factor, *shapes}
    size = compliance_parameter(gamma, ordinary, line.link, length_m=line.length_m)

    def starting_points(values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        return [{**values, gamma: _START * size.std}]

    return Instance(
        effect=words,
        place=line.name,
        ends_at=tuple(joint.name for joint in ordinary.arm.joints[line.link : line.link + 2]),
        parameters=(
            size,
            loss_parameter(loss),
            loss_factor_parameter(factor),
            Parameter(name=spread, unit="", mean=MASS_SPREAD, std=_SPREAD_STD, low=0.0, high=1.0),
            place_parameter(place),
            Parameter(
                name=stretch,
                unit="",
                mean=_STRETCH,
                std=_STRETCH_STD,
                low=_STRETCH_LEAST,
                high=_STRETCH_MOST,
                untold=_STRETCH_MOST,
            ),
            Parameter(name=taper, unit="", mean=0.0, std=_TAPER_STD, untold=0.0),
            Parameter(name=middle, unit="", mean=0.0, std=_MIDDLE_STD, untold=0.0),
            *yielding.parameters,
        ),
        builder=build,
        describe=describe,
        alternatives=alternatives,
        initial_values=starting_points,
        size=gamma,
        shapes=shapes,
        details=shapes,
        pieces=f"hinges {line.name}",
        material=material * ordinary.scale(line.link) / line.length_m,
        drives=ordinary.drives(line.link),
    )
