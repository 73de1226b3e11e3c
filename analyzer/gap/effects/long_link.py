"""What a link that bends and one that twists have in common: a line, places where it gives way."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import numpy.typing as npt
import scipy.special

from armodal.analyzer.gap.effects.compliance import compliance_parameter
from armodal.analyzer.gap.effects.link_axis import at_axis, splits
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.interface import loss_factor_parameter, loss_parameter
from armodal.analyzer.gap.model.long_links import SLICES, LongLink, long_links
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter
from armodal.analyzer.gap.model.spread import apart

__all__ = ["given_way"]

Array = npt.NDArray[np.float64]

_SPREAD, _SPREAD_STD = 0.6, 0.3  # of its length that a link's mass is spread over
# Where along it a link gives way: ln of its softness at the tip over that at the root, and at the
# middle over that of the ends.
_TAPER_STD, _MIDDLE_STD = 1.9, 1.9
_ASIDE_STD_M = 0.03  # of the line it gives way along, across it
_START = 0.03  # of the size's deviation: from zero a first step misleads


def given_way(
    ordinary: Ordinary,
    line: LongLink,
    ways: Callable[[LongLink], Sequence[Array]],
    words: EffectWords,
    *,
    word: str,
    material: float,
) -> Instance:
    """A link whose compliance each way is spread over its length, 1/EI or 1/GJ.

    Castings taper, and flanges stiffen their ends: how much of it is where is a parameter. So is
    where the line stands: drives and covers draw the centre of mass aside. The link's mass is in
    pieces between the hinges, spread evenly over a part of its length about its centre, as far as
    its own inertia allows; points turn with the stretch they stand on.
    """
    gamma, loss, factor, spread, taper, middle = (
        f"{word} {what} {line.name}"
        for what in ("compliance", "loss", "loss factor", "spread", "taper", "middle")
    )
    aside = [f"{word} aside {letter} {line.name}" for letter in "ab"]
    directions = ways(line)
    columns = ordinary.superset.interface_columns(line.link)
    part = line.length_m / SLICES
    hinges = []
    for number, (s, twist) in enumerate(line.twists(directions)):
        column, by_aside = np.zeros(ordinary.superset.n), np.zeros((2, ordinary.superset.n))
        column[columns] = twist
        levers = np.cross(across(line.along).T, twist[3:])
        by_aside[:, columns] = np.hstack([levers, np.zeros((2, 3))])
        stretch = s - 0.5 * part, s + 0.5 * part
        before = 1 + number // len(directions)
        hinges.append((column, by_aside, line.inside(ordinary.superset, *stretch, before)))
    edges = np.array([0.0, *line.places_m, line.length_m])
    shares = np.diff(edges) / line.length_m
    middles = 0.5 * (edges[1:] + edges[:-1]) - 0.5 * line.length_m

    body = ordinary.arm.joints[line.link].link

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        # A link that both bends and twists is in the same pieces.
        offsets = apart(body, line.along, shares, values[spread] * middles)
        assembly.pieces.setdefault(line.link, (shares, offsets))
        parts, by_shape = _parts(values[taper], values[middle])
        off = np.array([values[name] for name in aside])
        for number, (column, by_aside, inside) in enumerate(hinges):
            where = number // len(directions)
            slopes = line.length_m * by_shape[:, where]
            at = assembly.add_compliance(
                column + off @ by_aside,
                values[gamma],
                values[loss],
                gamma,
                loss,
                part=line.length_m * float(parts[where]),
                part_slopes=dict(zip((taper, middle), slopes.tolist(), strict=True)),
            )
            assembly.add_loss_factor([at], values[factor], factor)
            assembly.inside[at] = inside
            for name, moved in zip(aside, by_aside, strict=True):
                assembly.motion_of.setdefault(name, []).append((at, moved))

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        """Both ends of the line along which it gives way, in the link's frame."""
        start = line.start_m + across(line.along) @ [values[name] for name in aside]
        end = start + line.length_m * line.along
        name = ordinary.arm.joints[line.link].link.name
        return {"link": name, "from_m": start.tolist(), "to_m": end.tolist()}

    def alternatives(
        values: Mapping[str, float],
    ) -> Sequence[tuple[Instance, Mapping[str, float]]]:
        """Another such link, as soft from end to end: beyond a joint in line both turn alike.

        Or an axis in this one, where it is softest, with its first points before it.
        """
        rest = {k: v for k, v in values.items() if k not in own}
        whole = values[gamma] * line.length_m
        parts, _ = _parts(values[taper], values[middle])
        at_m = line.length_m * float(parts @ ((np.arange(SLICES) + 0.5) / SLICES))
        aside_m = across(line.along) @ [values[name] for name in aside]
        point_m = line.start_m + aside_m + at_m * line.along
        axes = [
            at_axis(ordinary, line.link, u, point_m, before=points)
            for u in directions
            for points in splits(ordinary, line.link)
        ]
        return [(axis, rest | {axis.size: whole}) for axis in axes] + [
            (
                there := given_way(ordinary, other, ways, words, word=word, material=material),
                rest | {there.size: whole / other.length_m},
            )
            for other in long_links(ordinary.superset)
            if abs(other.link - line.link) == 1
        ]

    own = {gamma, loss, factor, spread, taper, middle, *aside}
    size = compliance_parameter(gamma, ordinary, line.link, length_m=line.length_m)

    def starting_points(values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        return [{**values, gamma: _START * size.std}]

    return Instance(
        effect=words,
        place=line.name,
        parameters=(
            size,
            loss_parameter(loss),
            loss_factor_parameter(factor),
            Parameter(name=spread, unit="", mean=_SPREAD, std=_SPREAD_STD, low=0.0, high=1.0),
            Parameter(name=taper, unit="", mean=0.0, std=_TAPER_STD, untold=0.0),
            Parameter(name=middle, unit="", mean=0.0, std=_MIDDLE_STD, untold=0.0),
            *(
                Parameter(name=name, unit="m", mean=0.0, std=_ASIDE_STD_M, untold=0.0)
                for name in aside
            ),
        ),
        builder=build,
        describe=describe,
        alternatives=alternatives,
        initial_values=starting_points,
        size=gamma,
        shapes=(spread, taper, middle, *aside),
        pieces=f"hinges {line.name}",
        material=material * ordinary.scale(line.link) / line.length_m,
    )


def _parts(taper: float, middle: float) -> tuple[Array, Array]:
    """Parts (SLICES,) of the whole that each hinge yields, and their slopes (2, SLICES)."""
    place = (np.arange(SLICES) + 0.5) / SLICES - 0.5
    by = np.stack([place, 1.0 - 2.0 * np.abs(place)])
    parts = scipy.special.softmax(np.array([taper, middle]) @ by)
    return parts, parts * (by - (by @ parts)[:, None])
