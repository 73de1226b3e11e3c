"""What a link that bends and one that twists have in common: a line, places where it gives way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects.compliance import compliance_parameter, loss_parameter
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.long_links import SLICES, LongLink
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter
from armodal.analyzer.gap.model.spread import nearer

__all__ = ["given_way"]

Array = npt.NDArray[np.float64]

_SPREAD, _SPREAD_STD = 0.6, 0.3  # of its length that a link's mass is spread over
_START = 0.03  # of the size's deviation: from zero a first step misleads


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
    its centre, as far as its own inertia allows; points turn with the stretch they stand on.
    """
    gamma, loss, spread = (
        f"{word} {what} {line.name}" for what in ("compliance", "loss", "spread")
    )
    columns = ordinary.superset.interface_columns(line.link)
    part = line.length_m / SLICES
    hinges = []
    for number, (s, twist) in enumerate(line.twists(directions)):
        column = np.zeros(ordinary.superset.n)
        column[columns] = twist
        stretch = s - 0.5 * part, s + 0.5 * part
        before = 1 + number // len(directions)
        hinges.append((column, line.inside(ordinary.superset, *stretch, before)))
    edges = np.array([0.0, *line.places_m, line.length_m])
    shares = np.diff(edges) / line.length_m
    middles = 0.5 * (edges[1:] + edges[:-1]) - 0.5 * line.length_m

    body, apart = ordinary.arm.joints[line.link].link, np.outer(middles, line.along)
    most = nearer(body, shares, apart)

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        # A link that both bends and twists is in the same pieces.
        offsets = min(values[spread], most) * apart
        assembly.pieces.setdefault(line.link, (shares, offsets))
        for column, inside in hinges:
            at = assembly.add_compliance(
                column, values[gamma], values[loss], gamma, loss, part=part
            )
            assembly.inside[at] = inside

    size = compliance_parameter(gamma, ordinary, line.link, length_m=line.length_m)

    def starting_points(values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
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
        initial_values=starting_points,
        size=gamma,
        shapes=(spread,),
        pieces=f"hinges {line.name}",
        material=material * ordinary.scale(line.link) / line.length_m,
    )
