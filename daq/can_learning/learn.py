"""Which field of which frame is which joint: what follows a joint's typed angle, and no other's.

A field is a joint's if its value, at rest, is a straight line of the angle that the pendant shows,
within what the pendant rounds off, over three angles at least, while every other joint moves too;
and if the arm's whole range fits into it. All joints of a controller are taken to be written alike.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt

from armodal.daq.can_learning.fields import Field, FieldFormat, Kind, fields_of, formats
from armodal.daq.can_learning.scales import likely_offset, likely_scale
from armodal.protocols.can_records import CanFrame
from armodal.protocols.errors import CanError

__all__ = ["Learned", "LearnedJoint", "Station", "learn"]

Array = npt.NDArray[np.float64]
Key = tuple[int, bool]

FEWEST_FRAMES = 3  # of an identifier at a station
FEWEST_ANGLES = 3  # of a joint: a straight line through two is no test of it
COARSEST_DEG = 0.1  # of a count, and of what an angle at rest wanders: coarser is part of a number
# In any unit of angle a joint moves farther; an integer read as a float may be 1e-322.
LEAST_SPREAD = 1e-6
MOST_RESTLESS = 128.0  # counts at rest, from which the lowest byte tells nothing


@dataclass(frozen=True, slots=True, kw_only=True)
class Station:
    """The arm at rest: frames heard, and what the pendant shows."""

    joints_deg: tuple[float, ...]
    frames: tuple[CanFrame, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnedJoint:
    """angle in degrees = factor_deg * number + offset_deg."""

    joint: str
    field: Field
    factor_deg: float
    offset_deg: float
    is_round: bool  # the factor is a usual one, not the fitted
    residual_deg: float  # largest against the angles typed
    error_deg: float  # what the factor may be off at the far end of the joint's range
    also: tuple[Field, ...]  # other places that say the same


@dataclass(frozen=True, slots=True, kw_only=True)
class Learned:
    """What was found.

    `missing` says of each joint without a field why. `counters` is the byte of an identifier that
    goes up by one with every frame.
    """

    joints: tuple[LearnedJoint, ...]
    missing: Mapping[str, str]
    counters: Mapping[Key, int]
    lengths: Mapping[Key, int]


@dataclass(frozen=True, slots=True)
class _Heard:
    """Frames of one identifier, by station."""

    key: Key
    data: tuple[npt.NDArray[np.uint8], ...]

    @property
    def length(self) -> int:
        return int(self.data[0].shape[1])


def learn(
    stations: Sequence[Station],
    joints: Sequence[str],
    ranges_deg: Sequence[tuple[float, float]],
    *,
    rounding_deg: float,
) -> Learned:
    """Find each joint's field.

    Parameters
    ----------
    stations
        Every joint at three angles at least.
    ranges_deg
        Of each joint, as the arm file has them.
    rounding_deg
        Half of the last digit that the pendant shows.

    Raises
    ------
    CanError
        If nothing was heard, or a joint was not at three angles; every such joint is named.
    """
    angles = np.array([station.joints_deg for station in stations])
    _check_angles(angles, joints, rounding_deg)
    heard = _by_identifier(stations)
    if not heard:
        raise CanError(
            "wanted frames of one identifier at every station, got none; is the channel right, its "
            "bit rate, and does the controller send joint angles while the arm stands?"
        )
    counters = _counters(heard)
    best: list[list[_Fit]] = [[] for _ in joints]
    for form in formats():
        found = [
            _fits(heard, form, angles, number, limits, counters=counters, rounding_deg=rounding_deg)
            for number, limits in enumerate(ranges_deg)
        ]
        chosen = _apart(found)
        if sum(map(bool, chosen)) > sum(map(bool, best)):
            best = chosen
        if all(best):
            break
    made = partial(_made, angles=angles, ranges_deg=ranges_deg, rounding_deg=rounding_deg)
    return Learned(
        joints=tuple(made(name, i, best[i]) for i, name in enumerate(joints) if best[i]),
        missing={
            name: _why_not(heard, angles, i, joints, rounding_deg)
            for i, name in enumerate(joints)
            if not best[i]
        },
        counters=counters,
        lengths={one.key: one.length for one in heard},
    )


@dataclass(frozen=True, slots=True)
class _Fit:
    field: Field
    values: Array  # (n_stations,)
    restless: float  # largest spread at rest, in counts


def _check_angles(angles: Array, joints: Sequence[str], rounding_deg: float) -> None:
    apart = 4.0 * rounding_deg
    still = [
        name
        for i, name in enumerate(joints)
        if np.sum(np.diff(np.sort(angles[:, i])) > apart) + 1 < FEWEST_ANGLES
    ]
    if still:
        raise CanError(
            f"wanted every joint at {FEWEST_ANGLES} angles, got fewer of {', '.join(still)}; move "
            "each of them alone, twice"
        )


def _by_identifier(stations: Sequence[Station]) -> list[_Heard]:
    """Identifiers that come at every station, always of one length of two bytes or more."""
    by_key: dict[Key, list[list[bytes]]] = {}
    for i, station in enumerate(stations):
        for frame in station.frames:
            if not frame.remote:
                rows = by_key.setdefault((frame.can_id, frame.extended), [[] for _ in stations])
                rows[i].append(frame.data)
    result = []
    for key, rows in sorted(by_key.items()):
        lengths = {len(data) for row in rows for data in row}
        if min(map(len, rows)) >= FEWEST_FRAMES and len(lengths) == 1 and max(lengths) >= 2:
            data = tuple(np.array([list(d) for d in row], dtype=np.uint8) for row in rows)
            result.append(_Heard(key, data))
    return result


def _fits(
    heard: Sequence[_Heard],
    form: FieldFormat,
    angles: Array,
    number: int,
    limits_deg: tuple[float, float],
    *,
    counters: Mapping[Key, int],
    rounding_deg: float,
) -> list[_Fit]:
    """Fields of a format that follow a joint; a byte that never changes at an end is no part."""
    result = []
    for one in heard:
        every = np.concatenate(one.data)
        idle = np.all(every == every[0], axis=0)
        for field in fields_of(*one.key, one.length, form):
            last = field.first_byte + form.n_bytes - 1
            lowest = field.first_byte if form.little_endian else last
            if form.kind is not Kind.FLOAT and idle[lowest]:
                continue
            if counters.get(one.key, -1) in field.bytes:
                continue
            read = [field.read(data) for data in one.data]
            values = np.array([np.median(row) for row in read])
            restless = max(float(np.max(row) - np.min(row)) for row in read)
            if not (np.all(np.isfinite(values)) and np.isfinite(restless)):
                continue
            if np.ptp(values) <= max(2.0 * restless, LEAST_SPREAD):
                continue
            count = 0.0 if form.kind is Kind.FLOAT else 1.0
            if count and restless >= MOST_RESTLESS:
                continue
            factor, offset, residual = _line(values, angles[:, number])
            wanders_deg = abs(factor) * (restless + count)
            # Each angle typed is rounded, and so is the line that goes through them.
            if wanders_deg > COARSEST_DEG or residual > 2.0 * rounding_deg + wanders_deg:
                continue
            ends = sorted(factor * np.array(form.limits) + offset)
            if ends[0] <= limits_deg[0] and limits_deg[1] <= ends[1]:
                result.append(_Fit(field, values, restless))
    return result


def _line(values: Array, angles: Array) -> tuple[float, float, float]:
    """Slope, intercept and largest residual of angle over value."""
    middle = values.mean()
    centred = values - middle
    factor = float(centred @ angles / (centred @ centred))
    offset = float(angles.mean() - factor * middle)
    return factor, offset, float(np.max(np.abs(factor * values + offset - angles)))


def _apart(found: Sequence[Sequence[_Fit]]) -> list[list[_Fit]]:
    """For each joint its fits that share no byte with those of the joints before."""
    chosen: list[list[_Fit]] = []
    for fits in found:
        taken = [fit.field for row in chosen for fit in row]
        chosen.append([f for f in fits if not any(f.field.overlaps(other) for other in taken)])
    return chosen


def _made(
    joint: str,
    number: int,
    fits: Sequence[_Fit],
    *,
    angles: Array,
    ranges_deg: Sequence[tuple[float, float]],
    rounding_deg: float,
) -> LearnedJoint:
    """Of several places the most restless: a measured angle is noisy, a commanded one is not."""
    fit = max(fits, key=lambda one: one.restless)
    wanted = angles[:, number]
    factor, offset, _ = _line(fit.values, wanted)
    span = float(np.ptp(wanted))
    allowed = rounding_deg + abs(factor) * (fit.restless + 1.0)
    # Both ends of the line off by their rounding, and half of that for what lies between.
    usual = likely_scale(factor, 3.0 * allowed / span)
    if usual is not None:
        factor = usual
        offset = float(np.mean(wanted - factor * fit.values))
    offset = likely_offset(offset, allowed)
    residual = float(np.max(np.abs(factor * fit.values + offset - wanted)))
    low, high = ranges_deg[number]
    beyond = max(abs(low - wanted.mean()), abs(high - wanted.mean()))
    return LearnedJoint(
        joint=joint,
        field=fit.field,
        factor_deg=factor,
        offset_deg=offset,
        is_round=usual is not None,
        residual_deg=residual,
        error_deg=allowed if usual is not None else allowed * max(1.0, 2.0 * beyond / span),
        also=tuple(f.field for f in fits if not f.field.overlaps(fit.field)),
    )


def _why_not(
    heard: Sequence[_Heard],
    angles: Array,
    number: int,
    joints: Sequence[str],
    rounding_deg: float,
) -> str:
    """Whether a field follows the joint and others together, as behind a coupled gear."""
    design = np.column_stack([angles, np.ones(len(angles))])
    if len(angles) > design.shape[1]:
        for form in formats():
            for one in heard:
                for field in fields_of(*one.key, one.length, form):
                    values = np.array([np.median(field.read(data)) for data in one.data])
                    if not np.all(np.isfinite(values)) or np.ptp(values) == 0.0:
                        continue
                    parts = np.linalg.lstsq(design, values, rcond=None)[0]
                    left = float(np.max(np.abs(design @ parts - values)))
                    own = abs(float(parts[number]))
                    others = [
                        i
                        for i in range(len(joints))
                        if i != number and abs(parts[i]) > 0.02 * own > 0.0
                    ]
                    if own > 0.0 and others and left <= own * rounding_deg * 2.0:
                        names = ", ".join(joints[i] for i in others)
                        return (
                            f"{field.words()} follows it together with {names}: the angle of a "
                            "motor behind a coupled gear; a controller that sends joint angles "
                            "is needed"
                        )
    return "no whole-byte field follows it alone"


def _counters(heard: Sequence[_Heard]) -> dict[Key, int]:
    """Bytes that go up by one with every frame."""
    found = {}
    for one in heard:
        # Differences of bytes are taken modulo 256.
        steps = np.concatenate([data[1:] - data[:-1] for data in one.data])
        for byte in np.flatnonzero(np.all(steps == 1, axis=0)):
            found[one.key] = int(byte)
    return found
