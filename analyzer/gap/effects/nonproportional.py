"""A damper between two links, or a link and the floor: losses that follow no joint's stiffness.

It resists the rate of its length. With u along it and v the velocities of its ends,

    C + c r r',    r x' = u (v_to - v_from) ,

so one number of damping couples all joints between its ends, by levers that change with posture.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.effects.shared_axis import is_on_shared_axis
from armodal.analyzer.gap.model.assembly import Assembly
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.geometry import PostureGeometry, skew
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.scales import foot_m, steps_m
from armodal.analyzer.gap.model.space import Parameter

__all__ = ["FLOOR", "WORDS", "between", "ends_of", "instances", "size_std", "velocity"]

Array = npt.NDArray[np.float64]

WORDS = EffectWords(
    name="nonproportional",
    title="Damper between links that no joint explains",
    changes="damping between several joints at once, beside the diagonal of C",
    signature="damping ratios that change with posture; complex shapes near each other",
    confused_with=("load_damping", "coupling", "friction"),
    covers=("nonproportional",),  # what one leaves looks like more, chains of them like anything
    ends_alike=True,  # floor and first link differ by a turn about the vertical
    own_candidates=True,
    told_by="postures that turn the line between both ends; the hose or pack taken off",
    remedy="look for a hose, a dress pack, a damper or a seal that reaches over several joints",
)
FLOOR = -1
_MATERIAL = 0.1  # of a standard deviation
_STD_M, _FLOOR_STD_M = 0.15, 0.3
_FLOOR_M = (0.0, 0.0, 0.1)
_SIZE = 5.0  # of the mean joint damping over the square of a lever
_LEVER, _LEAST_M = 0.6, 1e-3  # of the longest step from joint to joint; a length that is none


def instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """From the floor or the first link to what is beyond the second joint, wrist left out."""
    last = len(ordinary.arm.joints) - 2
    return tuple(
        between(ordinary, near, far) for near in (FLOOR, 0) for far in range(2, min(4, last))
    )


def ends_of(ordinary: Ordinary, near: int, far: int) -> tuple[str, str]:
    """Return the names of both ends."""
    names = [joint.link.name for joint in ordinary.arm.joints]
    return "floor" if near == FLOOR else names[near], names[far]


def size_std(ordinary: Ordinary) -> float:
    """Return damping of such a damper that is much beside the joints' own, N s/m."""
    dampings = [ordinary.arm.joints[i].damping for i in ordinary.elastic[:3]]
    mean = float(np.mean([1.0 if d is None else d.value for d in dampings]))
    return _SIZE * mean / (_LEVER * max(*steps_m(ordinary.superset), _LEAST_M)) ** 2


def middle_of(ordinary: Ordinary, link: int) -> Array:
    """Return where an end is likely, in the link's frame."""
    if link == FLOOR:
        return foot_m(ordinary.superset) + _FLOOR_M
    return ordinary.arm.joints[link].link.center_m


def between(ordinary: Ordinary, near: int, far: int) -> Instance:
    """A damper between two links, its ends somewhere about their middles."""
    from_link, to_link = ends_of(ordinary, near, far)
    tag = f"{from_link} {to_link}"
    name = f"damper {tag}"
    from_coordinates = [f"damper from {axis} {tag}" for axis in "xyz"]
    to_coordinates = [f"damper to {axis} {tag}" for axis in "xyz"]
    std = size_std(ordinary)

    def build(assembly: Assembly, values: Mapping[str, float]) -> None:
        start, end = (
            np.array([values[n] for n in names]) for names in (from_coordinates, to_coordinates)
        )
        columns = np.stack(assembly.columns, axis=1)
        row, slopes = _row(assembly.geometry, near, far, start, end)
        turns = dict(zip((*from_coordinates, *to_coordinates), slopes @ columns, strict=True))
        for moved, ways in assembly.motion_of.items():  # of other effects: it stretches with them
            turns[moved] = np.zeros(len(assembly.columns))
            for at, way in ways:
                turns[moved][at] = row @ way
        assembly.add_stretch(
            "damping", row @ columns, values[name], parameter=name, slope=1.0, turns=turns
        )

    def describe(values: Mapping[str, float]) -> dict[str, object]:
        return {
            "from_link": from_link,
            "from_m": [values[n] for n in from_coordinates],
            "link": to_link,
            "point_m": [values[n] for n in to_coordinates],
        }

    def alternatives(
        values: Mapping[str, float],
    ) -> Sequence[tuple[Instance, Mapping[str, float]]]:
        """As strong a damper between other links, at the same end where both share one."""
        rest = {
            k: v for k, v in values.items() if k not in {name, *from_coordinates, *to_coordinates}
        }
        found: list[tuple[Instance, Mapping[str, float]]] = []
        for other in instances(ordinary):
            if other.place == f"{from_link} and {to_link}":
                continue
            begin = {**rest, other.size: values[name]}
            theirs = other.place.split(" and ")
            half = len(other.shapes) // 2
            if theirs[0] == from_link:
                begin |= {
                    new: values[old]
                    for new, old in zip(other.shapes[:half], from_coordinates, strict=True)
                }
            if theirs[1] == to_link:
                begin |= {
                    new: values[old]
                    for new, old in zip(other.shapes[half:], to_coordinates, strict=True)
                }
            found.append((other, begin))
        return found

    def is_also(values: Mapping[str, float], other: Instance) -> bool:
        """A damper that ends on a joint's axis ends on either link of that joint."""
        end = np.array([values[n] for n in to_coordinates])
        theirs = other.place.split(" and ")[-1]
        return other.effect is WORDS and is_on_shared_axis(ordinary, far, end, theirs)

    def place(names: list[str], link: int) -> list[Parameter]:
        std_m = _FLOOR_STD_M if link == FLOOR else _STD_M
        middle = middle_of(ordinary, link).tolist()
        return [
            Parameter(name=n, unit="m", mean=m, std=std_m)
            for n, m in zip(names, middle, strict=True)
        ]

    return Instance(
        effect=WORDS,
        place=f"{from_link} and {to_link}",
        parameters=(
            Parameter(name=name, unit="N s/m", mean=0.0, std=std, low=0.0),
            *place(from_coordinates, near),
            *place(to_coordinates, far),
        ),
        builder=build,
        describe=describe,
        alternatives=alternatives,
        is_also=is_also,
        size=name,
        shapes=(*from_coordinates, *to_coordinates),
        material=_MATERIAL * std,
        last=True,
    )


def velocity(geometry: PostureGeometry, link: int, place_m: Array) -> tuple[Array, Array]:
    """Place (3,) in the base frame and velocity (3, N) by the superset's freedoms of a point."""
    J, R = geometry.link_jacobian[link], _axes(geometry, link)
    turned = R @ J[:3, 3:6]  # minus the cross product with the link's origin
    origin = np.array([turned[1, 2], turned[2, 0], turned[0, 1]])
    return origin + R @ place_m, R @ (J[:3] - skew(place_m) @ J[3:])


def _axes(geometry: PostureGeometry, link: int) -> Array:
    """(3, 3) from the link's frame to the base's: how a place moves with its coordinates."""
    return np.asarray(geometry.link_jacobian[link][:3, :3].T)


def _row(
    geometry: PostureGeometry, near: int, far: int, start: Array, end: Array
) -> tuple[Array, Array]:
    """Row (N,) that stretches the damper, and its slopes (6, N) by the places of both ends."""
    to, v = velocity(geometry, far, end)
    at = start
    if near != FLOOR:
        at, v_from = velocity(geometry, near, start)
        v = v - v_from
    line = to - at
    length = max(float(np.linalg.norm(line)), _LEAST_M)
    u = line / length
    turned = (v - np.outer(u, u @ v)) / length  # what the end's own way turns the line into
    by_start = -turned if near == FLOOR else -_by_place(geometry, near, u, turned)
    return u @ v, np.concatenate([by_start, _by_place(geometry, far, u, turned)])


def _by_place(geometry: PostureGeometry, link: int, u: Array, turned: Array) -> Array:
    """(3, N) of what a place's coordinates change: the line's way, and the place's velocity."""
    R, spin = _axes(geometry, link), geometry.link_jacobian[link][3:]
    return np.asarray(R.T @ turned + np.cross(u @ R, spin.T).T)
