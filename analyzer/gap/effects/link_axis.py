"""A compliance axis inside a link, in any direction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects.compliance import compliance_parameter
from armodal.analyzer.gap.library import all_instances
from armodal.analyzer.gap.model.assembly import Assembly, Inside
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.geometry import across
from armodal.analyzer.gap.model.interface import loss_factor_parameter, loss_parameter
from armodal.analyzer.gap.model.lines_in_links import LineInLink, described_line
from armodal.analyzer.gap.model.long_links import LongLink, long_links, span_m
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.space import Parameter
from armodal.analyzer.gap.model.spread import apart, second_moment
from armodal.protocols.arm.records import Joint

__all__ = ["WORDS", "at_axis", "instances", "of_file", "splits"]

Array = npt.NDArray[np.float64]

WORDS = EffectWords(
    name="link_axis",
    title="Link is compliant about an axis of its own",
    changes="releases one rotation about a line of the link, between its joint and its mass",
    signature="a mode whose motion turns about one line that moves with the link",
    confused_with=("bearing", "released_joint", "base", "link_bending", "link_torsion"),
    told_by="triplets of points on both sides of the line; postures that move the masses beyond it",
    remedy="look for a soft casting, a loose flange or a gear housing on its bolts along that line",
    some_is_ordinary=True,
    one_with=("friction", "microslip", "softening", "backlash"),
    separate_minima=True,
    one_such_as="a crack or a bolt in the link that opens under one sign of load",
)
_MATERIAL = 0.012  # of its drive's compliance
_LEAST_M, _LEAST_KG = 1e-6, 1e-6
_PARALLEL, _THROUGH_M = 0.98, 0.03  # to a joint's axis: 11 degrees, 30 mm
_ALONG = 0.7  # cosine: an axis nearer to its link's line twists it, one further bends it
# Of an even rod's, how far apart both pieces' centres are; at most, halves of a rod are points.
_SPREAD, _SPREAD_STD, _SPREAD_MOST = 0.8, 1.0 / 3.0, 2.0 / np.sqrt(3.0)
# Of the link's mass: anywhere along it, mean and deviation of an even draw.
_BEFORE, _BEFORE_STD, _BEFORE_MOST = 0.5, 1.0 / np.sqrt(12.0), 0.9


def at_axis(
    ordinary: Ordinary,
    link: int,
    direction: Array,
    point_m: Array,
    *,
    before: Sequence[str] = (),
) -> Instance:
    """An axis near a line of a link's frame.

    Parameters
    ----------
    direction, point_m
        (3,) unit direction and a point of the line the fit begins with.
    before
        Ids of the link's points that stand between its joint and the axis, with a part of its
        mass; without any the whole link is beyond.
    """
    own_line = LineInLink(ordinary, link, direction, point_m, of="axis")
    name, moves = own_line.name, own_line.moves
    gamma, loss, factor, part, spread = (
        f"axis {what} {name}"
        for what in ("compliance", "loss", "loss factor", "mass before", "mass spread")
    )
    body = ordinary.arm.joints[link].link
    along, half_m = _along(ordinary, link), 0.5 * _even_length_m(ordinary, link)
    still = np.flatnonzero([point.id in before for point in ordinary.arm.points])
    inside = Inside(
        link=link,
        before=1,
        points=still,
        part=np.zeros(len(still)),
        shift_m=np.zeros((len(still), 3)),
    )
    columns = ordinary.superset.interface_columns(link)

    @lru_cache(maxsize=2)  # for all postures
    def line(*by: float) -> tuple[Array, Array]:
        twist, slopes = own_line.turn(dict(zip(moves, by, strict=True)))
        motion = np.zeros((1 + len(moves), ordinary.superset.n))
        motion[:, columns] = np.vstack([twist, slopes])
        motion.setflags(write=False)
        return motion[0], motion[1:]

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        column, slopes = line(*(values[m] for m in moves))
        at = assembly.add_compliance(column, values[gamma], values[loss], gamma, loss)
        assembly.add_loss_factor([at], values[factor], factor)
        for move, slope in zip(moves, slopes, strict=True):
            assembly.motion_of[move] = [(at, slope)]
        if before:
            # Both pieces lie one behind the other along the link, their common centre the link's.
            shares = np.array([values[part], 1.0 - values[part]])
            places = values[spread] * half_m * np.array([-shares[1], shares[0]])
            assembly.pieces[link] = shares, apart(body, along, shares, places)
            assembly.inside[at] = inside

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        found = own_line.describe(values)
        return {**found, "points_before": " ".join(before)} if before else found

    def alternatives(
        values: Mapping[str, float],
    ) -> Sequence[tuple[Instance, Mapping[str, float]]]:
        u, p = own_line.at(values)
        rest = {k: v for k, v in values.items() if k not in own}
        found = _at_both_ends(ordinary, link, u, values[gamma], rest)
        found += _all_along(ordinary, link, u, values[gamma], rest)
        turned = {k: v for k, v in values.items() if k not in moves}
        return found + [
            (at_axis(ordinary, link, u, p, before=points), turned)
            for points in ((), *splits(ordinary, link))
            if points != tuple(before)
        ]

    def is_also(values: Mapping[str, float], other: Instance) -> bool:
        """Where the line is the joint's own, the joint gives way; where a tube's, that twists.

        Between two joints whose axes meet, one through that place that turns about both is a
        coupling of theirs.
        """
        joint = ordinary.arm.joints[link]
        u, p = own_line.at(values)
        line = _tube(ordinary, link)
        if other.key == ("released_joint", joint.name):
            along, start = np.asarray(joint.axis), np.zeros(3)
        elif other.key == ("link_torsion", name) and line is not None:
            along, start = line.along, line.start_m
        elif other.effect.name == "coupling" and link + 1 < len(ordinary.arm.joints):
            beyond = ordinary.arm.joints[link + 1]
            if other.place != f"{joint.name} and {beyond.name}":
                return False
            return _turns_about_both(u, p, joint, beyond)
        else:
            return False
        off = np.linalg.norm(np.cross(p - start, along))
        return bool(abs(u @ along) > _PARALLEL and off < _THROUGH_M)

    split = Parameter(name=part, unit="", mean=_BEFORE, std=_BEFORE_STD, low=0.0, high=_BEFORE_MOST)
    wide = Parameter(
        name=spread, unit="", mean=_SPREAD, std=_SPREAD_STD, low=0.0, high=_SPREAD_MOST
    )
    own = {gamma, loss, factor, part, spread, *moves}
    return Instance(
        effect=WORDS,
        place=name,
        parameters=(
            compliance_parameter(gamma, ordinary, link),
            loss_parameter(loss),
            loss_factor_parameter(factor),
            *own_line.parameters,
            *((split, wide) if before else ()),
        ),
        builder=build,
        describe=describe,
        alternatives=alternatives,
        is_also=is_also,
        begins_at=moves,
        size=gamma,
        shapes=(*moves, part, spread) if before else moves,
        material=_MATERIAL * ordinary.scale(link),
        drives=ordinary.drives(link),
        pieces=f"axis {name}" if before else "",
        is_line=not before,
    )


Begun = list[tuple[Instance, Mapping[str, float]]]


def at_ends(
    ordinary: Ordinary, link: int, direction: Array, size: float
) -> dict[str, tuple[float, float]]:
    """What the bearings at both ends of a link would have of an axis in it, by joint."""
    joints = ordinary.arm.joints
    found = {}
    for at, joint in enumerate(joints[link : link + 2]):
        own = direction if at == 0 else joint.T_parent_joint[:3, :3].T @ direction
        first, second = size * (own @ across(np.asarray(joint.axis))) ** 2
        found[joint.name] = float(first), float(second)
    return found


def _at_both_ends(
    ordinary: Ordinary, link: int, direction: Array, size: float, rest: Mapping[str, float]
) -> Begun:
    """An axis may stand for the bearing of the joint before it or beyond, or for that joint."""
    found: Begun = []
    joint = ordinary.arm.joints[link]
    about = size * float(direction @ np.asarray(joint.axis)) ** 2
    ends = at_ends(ordinary, link, direction, size)
    for instance in all_instances(ordinary):
        if instance.effect.name == "bearing" and instance.place in ends:
            more = zip(instance.sizes, ends[instance.place], strict=True)
            found.append((instance, {**rest, **{n: rest[n] + v for n, v in more}}))
        if instance.effect.name == "released_joint" and instance.place == joint.name:
            found.append((instance, {**rest, instance.size: rest[instance.size] + about}))
    return found


def _all_along(
    ordinary: Ordinary, link: int, direction: Array, size: float, rest: Mapping[str, float]
) -> Begun:
    """An axis in a long link may stand for one that twists or bends all along."""
    line = _tube(ordinary, link)
    if line is None:
        return []
    kind = "link_torsion" if abs(direction @ line.along) > _ALONG else "link_bending"
    return [
        (instance, {**rest, instance.size: size / line.length_m})
        for instance in all_instances(ordinary)
        if instance.key == (kind, line.name)
    ]


def _turns_about_both(u: Array, p: Array, joint: Joint, beyond: Joint) -> bool:
    """Whether a line along u through p turns about both joints' axes, where those meet."""
    T = beyond.T_parent_joint
    first, second, offset = np.asarray(joint.axis), T[:3, :3] @ np.asarray(beyond.axis), T[:3, 3]
    normal = np.cross(first, second)
    size = float(np.linalg.norm(normal))
    if size < np.sqrt(1.0 - _PARALLEL**2) or abs(offset @ normal) / size > _THROUGH_M:
        return False  # they do not meet
    meeting = first * float(np.cross(offset, second) @ normal) / size**2
    off = np.linalg.norm(np.cross(meeting - p, u))
    in_plane = abs(u @ normal) / size < np.sqrt(1.0 - _PARALLEL**2)
    return bool(in_plane and off < _THROUGH_M)


def _tube(ordinary: Ordinary, link: int) -> LongLink | None:
    """Return the line of a link that is long enough to twist."""
    return next((own for own in long_links(ordinary.superset) if own.link == link), None)


def of_file(ordinary: Ordinary, description: Mapping[str, object]) -> Instance | None:
    """Return the axis that an arm file describes; None where it does not."""
    line = described_line(ordinary, description)
    if line is None:
        return None
    before = str(description.get("points_before", "")).split()
    return at_axis(ordinary, *line, before=before)


def splits(ordinary: Ordinary, link: int) -> tuple[tuple[str, ...], ...]:
    """Return which of a link's points may stand before an axis: one, or more, the first ones.

    In the order along the link from its root to its tip, and by distance from the root: on a short
    link with a wide shell the two differ.
    """
    points = [
        point
        for point, own in zip(ordinary.arm.points, ordinary.superset.point_link, strict=True)
        if own == link
    ]
    root, tip = span_m(ordinary.superset, link)
    orders = (
        sorted(points, key=lambda point: float(point.position_m @ (tip - root))),
        sorted(points, key=lambda point: float(np.linalg.norm(point.position_m - root))),
    )
    found = [{p.id for p in order[:n]} for order in orders for n in range(1, len(points))]
    # As the arm file lists them: two orders may have the same points first.
    listed = [tuple(p.id for p in points if p.id in own) for own in found]
    return tuple(dict.fromkeys(listed))


def _along(ordinary: Ordinary, link: int) -> Array:
    """(3,) from a link's root to its tip."""
    root, tip = span_m(ordinary.superset, link)
    reach = tip - root
    return reach / max(float(np.linalg.norm(reach)), _LEAST_M)


def _even_length_m(ordinary: Ordinary, link: int) -> float:
    """How long an even rod of the link's mass is that has its second moment that way."""
    body, along = ordinary.arm.joints[link].link, _along(ordinary, link)
    second = float(along @ second_moment(body) @ along)
    return float(np.sqrt(12.0 * max(second, 0.0) / max(body.mass_kg, _LEAST_KG)))


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """None by itself: a scan of every interface proposes lines (`link_axis_candidates`)."""
    del ordinary
    return ()
