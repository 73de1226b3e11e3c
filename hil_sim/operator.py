"""The scripted operator: moves the arm, mounts the sensor and hits, when asked to.

Each action is a generator that yields the lab time until which it waits and returns the answer.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from armodal.hil_sim.cell import BlowT, Cell
from armodal.hil_sim.clock import LabClock
from armodal.hil_sim.faults import FaultSet
from armodal.hil_sim.ledger import LedgerWriter
from armodal.hil_sim.streams import Streams
from armodal.protocols.errors import PlantError

__all__ = ["Action", "Marking", "Operator", "Swing", "Workplace"]

Answer = dict[str, Any]
Action = Generator[float, None, Answer]

Array = npt.NDArray[np.float64]
BlowT_co = TypeVar("BlowT_co", covariant=True)


HARDNESS_N = (0.1, 1e4)  # a hand can hit


@dataclass(frozen=True, slots=True, kw_only=True)
class Marking:
    """Where a test point is marked on its link: the link's frame, axes of length 1."""

    position_m: tuple[float, ...]  # (3,)
    normal: tuple[float, ...]  # (3,) outwards, the sensor's z
    x_axis: tuple[float, ...]  # (3,) the sensor's x


class Swing(Protocol[BlowT_co]):
    """A hand that swings the hammer."""

    def __call__(
        self, point_id: str, direction: Array, peak_n: float | None
    ) -> tuple[BlowT_co, Mapping[str, object]]:
        """Return a blow at a point along a unit direction (3,), base frame, and what it is.

        Parameters
        ----------
        peak_n
            About how hard; None as the hand does by itself.
        """


# How long an operator takes, lab seconds.
MOUNT_S = (3.0, 6.0)
MARK_S = 2.0
SWING_S = (0.4, 1.0)
AFTER_HIT_S = 0.2


@dataclass(frozen=True, slots=True, kw_only=True)
class Workplace(Generic[BlowT]):
    """What the operator knows and can do."""

    cell: Cell[BlowT]
    move_to: Callable[[npt.ArrayLike], float]  # joint angles in rad -> lab time when settled
    swing: Swing[BlowT]
    ranges_rad: tuple[tuple[float, float], ...]
    points: frozenset[str]
    faults: FaultSet
    ledger: LedgerWriter
    mounted: Callable[[], Mapping[str, object]]  # how the sensor truly sits
    swing_at_mass: Callable[[float], tuple[BlowT, Mapping[str, object]]] | None = None
    mark: Callable[[str, Marking], None] | None = None  # a test point anew


class Operator(Generic[BlowT]):
    """Turns requests into actions."""

    def __init__(
        self,
        workplace: Workplace[BlowT],
        *,
        clock: LabClock,
        streams: Streams,
    ) -> None:
        self._at = workplace
        self._clock = clock
        self._mounts, self._swings = streams("time to mount"), streams("time to swing")
        self._begins = streams("begin of a blow")

    def begin(self, request: object) -> Action:
        """Begin what a request asks for.

        Raises
        ------
        PlantError
            If the request cannot be understood or carried out.
        """
        if not isinstance(request, dict):
            raise PlantError(f'wanted an object such as {{"do": "mount", ...}}, got {request!r}')
        match request.get("do"):
            case "posture":
                joints_rad = self._posture_of(request.get("joints_deg"))
                return self._go(str(request.get("name", "")), joints_rad)
            case "mount":
                return self._mount(self._point_of(request))
            case "hit":
                direction = _direction_of(request.get("direction"))
                return self._hit(self._point_of(request), direction, _peak_of(request))
            case "hit-mass":
                return self._hit_mass(request.get("mass_kg"))
            case "mark":
                return self._mark(self._point_of(request), _marking_of(request))
            case "fault":
                return self._fault(request.get("name"), request.get("active", True))
            case other:
                raise PlantError(
                    f'wanted "do": posture, mount, hit, hit-mass, mark or fault, got {other!r}'
                )

    def _go(self, name: str, joints_rad: Array) -> Action:
        yield self._at.move_to(joints_rad)
        self._at.ledger.note(
            "posture", self._clock.now_s(), name=name, joints_rad=self._at.cell.joints_rad
        )
        return {"done": True, "do": "posture", "name": name}

    def _mount(self, point: str) -> Action:
        yield self._clock.now_s() + self._mounts.uniform(*MOUNT_S)
        self._at.cell.mount(point)
        self._at.ledger.note("mount", self._clock.now_s(), point=point, **self._at.mounted())
        return {"done": True, "do": "mount", "point": point}

    def _hit(self, point: str, direction: Array, peak_n: float | None) -> Action:
        yield self._clock.now_s() + self._swings.uniform(*SWING_S)
        blow, facts = self._at.swing(point, direction, peak_n)
        at_sample = self._at.cell.strike(self._begins.uniform(1.0, 2.0), blow)
        self._at.ledger.note(
            "hit",
            self._clock.now_s(),
            point=point,
            wanted_direction=direction,
            at_sample=at_sample,
            sensor_point=self._at.cell.point,
            joints_rad=self._at.cell.joints_rad,
            **facts,
        )
        yield self._clock.now_s() + AFTER_HIT_S
        return {"done": True, "do": "hit", "point": point}

    def _hit_mass(self, mass_kg: object) -> Action:
        swing_at_mass = self._at.swing_at_mass
        heavy = isinstance(mass_kg, int | float) and 1e-3 <= mass_kg <= 1e3
        if not heavy or swing_at_mass is None:
            raise PlantError(f"mass_kg: wanted 0.001 to 1000 and a mass to hit, got {mass_kg!r}")
        yield self._clock.now_s() + self._swings.uniform(*SWING_S)
        blow, facts = swing_at_mass(float(str(mass_kg)))
        at_sample = self._at.cell.strike(self._begins.uniform(1.0, 2.0), blow)
        now_s = self._clock.now_s()
        self._at.ledger.note("hit-mass", now_s, mass_kg=mass_kg, at_sample=at_sample, **facts)
        yield self._clock.now_s() + AFTER_HIT_S
        return {"done": True, "do": "hit-mass"}

    def _mark(self, point: str, marking: Marking) -> Action:
        if self._at.mark is None:
            raise PlantError("this laboratory's points stay where they are")
        yield self._clock.now_s() + MARK_S
        self._at.mark(point, marking)
        self._at.ledger.note(
            "mark",
            self._clock.now_s(),
            point=point,
            position_m=marking.position_m,
            normal=marking.normal,
            x_axis=marking.x_axis,
        )
        return {"done": True, "do": "mark", "point": point}

    def _fault(self, name: object, active: object) -> Action:
        self._at.faults.switch(str(name), active=bool(active))
        self._at.ledger.note("fault", self._clock.now_s(), name=name, active=bool(active))
        yield self._clock.now_s()
        return {"done": True, "do": "fault", "name": name}

    def _point_of(self, request: dict[str, Any]) -> str:
        point = request.get("point")
        if not isinstance(point, str) or point not in self._at.points:
            known = ", ".join(sorted(self._at.points))
            raise PlantError(f"wanted a test point of the arm ({known}), got {point!r}")
        return point

    def _posture_of(self, joints_deg: object) -> Array:
        n = len(self._at.ranges_rad)
        joints = _numbers(joints_deg, n, "joints_deg")
        joints_rad = np.radians(joints)
        for i, (low, high) in enumerate(self._at.ranges_rad):
            if not low <= joints_rad[i] <= high:
                raise PlantError(
                    f"joint {i + 1}: wanted {math.degrees(low):g}...{math.degrees(high):g} "
                    f"degrees, got {joints[i]:g}"
                )
        return joints_rad


def _marking_of(request: dict[str, Any]) -> Marking:
    place, z, x = (_numbers(request.get(key), 3, key) for key in ("position_m", "normal", "x_axis"))
    if float(np.linalg.norm(z)) == 0.0 or float(np.linalg.norm(np.cross(z, x))) == 0.0:
        raise PlantError("normal, x_axis: wanted two directions that differ")
    z = z / np.linalg.norm(z)
    x = x - float(x @ z) * z
    x = x / np.linalg.norm(x)
    return Marking(position_m=tuple(place), normal=tuple(z), x_axis=tuple(x))


def _peak_of(request: dict[str, Any]) -> float | None:
    peak_n = request.get("peak_n")
    if peak_n is None:
        return None
    if not isinstance(peak_n, int | float) or not HARDNESS_N[0] <= peak_n <= HARDNESS_N[1]:
        low, high = HARDNESS_N
        raise PlantError(f"peak_n: wanted {low:g} to {high:g}, got {peak_n!r}")
    return float(peak_n)


def _direction_of(value: object) -> Array:
    direction = _numbers(value, 3, "direction")
    length = float(np.linalg.norm(direction))
    if length == 0.0:
        raise PlantError("direction: wanted three numbers not all zero")
    return direction / length


def _numbers(value: object, n: int, what: str) -> Array:
    if (
        isinstance(value, list)
        and len(value) == n
        and all(isinstance(x, int | float) and abs(x) < 1e6 for x in value)
    ):
        return np.array(value, dtype=np.float64)
    raise PlantError(f"{what}: wanted a list of {n} numbers, got {value!r}")
