"""Single hits of foreign files as the hits of a session: counts, channels, sampling."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array
from armodal.protocols.board.records import BoardDictionary, Channel, IepeState
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.force_pulse import pulse_onset, pulse_polarity
from armodal.protocols.foreign.manifest import PostureTable
from armodal.protocols.foreign.measured import AXES, ForeignHit
from armodal.protocols.foreign.placement import HIT, RESPONSE, Placement
from armodal.protocols.session.records import Hit, JointReading, Verdict

__all__ = [
    "PlacedHit",
    "foreign_dictionary",
    "hit_records",
    "place_hits",
    "pretrigger",
]

_COUNTS = 2**30  # of the largest value: 256 times finer than a 24-bit converter at half range
_ORTHOGONAL = 1e-6
_SAME_RATE = 1e-6  # relative: a rate worked out from times that were printed


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedHit:
    """A hit on the arm: signals along the sensor's own axes."""

    origin: str
    posture: str
    joints_rad: npt.NDArray[np.float64]
    sensor_point: str
    hit_point: str
    hit_direction: npt.NDArray[np.float64]  # (3,) base frame
    rate_hz: Fraction
    signals: npt.NDArray[np.float64]  # (1 + n_axes, n): force N, acceleration m/s²


def place_hits(
    hits: Sequence[ForeignHit], table: PostureTable, placement: Placement, said: list[str]
) -> list[PlacedHit]:
    """Put the hits of one posture on the arm.

    Raises
    ------
    ForeignFileError
        If the manifest tells what only averaged FRFs have, a point has more than one sensor, or
        directions are missing or not square.
    """
    _check_single(table)
    placed = []
    for hit in hits:
        hit_point = placement.hit_point(table.hit_point, hit.hit, hit.origin)
        if table.hit_direction is not None:
            vector = np.array(table.hit_direction)
            direction = frozen_array(vector / np.linalg.norm(vector), np.float64)
        else:
            direction = placement.direction(hit.hit, hit_point, HIT, hit.origin)
            if hit.hit.direction is None:
                said.append(f"posture {table.name!r}: the direction of the hit is not told")
        force = hit.force_n
        for point, one in _by_point(hit, placement):
            along = _along_sensor_axes(one, point, placement, said)
            placed.append(
                PlacedHit(
                    origin=hit.origin,
                    posture=table.name,
                    joints_rad=frozen_array(placement.joints_rad, np.float64),
                    sensor_point=point,
                    hit_point=hit_point,
                    hit_direction=direction,
                    rate_hz=hit.rate_hz,
                    signals=frozen_array(np.concatenate([force[None], along]), np.float64),
                )
            )
    return placed


def _by_point(hit: ForeignHit, placement: Placement) -> list[tuple[str, ForeignHit]]:
    """Part a hit by the points of its sensors: a session has one sensor a record."""
    rows: dict[str, list[int]] = {}
    for i, dof in enumerate(hit.responses):
        rows.setdefault(placement.point(dof, RESPONSE, hit.origin), []).append(i)
    for point, places in rows.items():
        if len(places) > len(AXES):
            raise ForeignFileError(
                f"{hit.origin}: wanted the accelerations of one sensor, up to {len(AXES)}, at a "
                f"point, got {len(places)} at {point}; name the others' points with `responses`"
            )
    return [
        (
            point,
            replace(
                hit,
                acceleration_m_s2=hit.acceleration_m_s2[places],
                responses=tuple(hit.responses[i] for i in places),
            ),
        )
        for point, places in rows.items()
    ]


def _check_single(table: PostureTable) -> None:
    """Refuse what a manifest may tell of averaged FRFs: a session's hits cannot carry it."""
    what = f"posture {table.name!r}"
    if table.averages is not None:
        raise ForeignFileError(
            f"{what}: averages: wanted none for single hits, got {table.averages}; leave it out: "
            "hits are averaged when FRFs are made of them"
        )
    if table.window_decay_rad_s is not None:
        raise ForeignFileError(
            f"{what}: window_decay_rad_s: wanted none for single hits, got "
            f"{table.window_decay_rad_s:g}: a window in their records cannot be carried on; export "
            "them without one, or import FRFs"
        )


def _along_sensor_axes(
    hit: ForeignHit, point: str, placement: Placement, said: list[str]
) -> npt.NDArray[np.float64]:
    """Accelerations along the sensor's axes at the point: (n_axes, n)."""
    told = [dof.direction for dof in hit.responses]
    if all(direction is None for direction in told):
        if len(told) != 3 and not placement.plain:
            raise ForeignFileError(
                f"{hit.origin}: wanted the directions of {len(told)} responses; name them with "
                "`responses` in the manifest"
            )
        said.append(
            f"{hit.origin.split(':', maxsplit=1)[0]}: the directions of the responses are not "
            "told; they are taken as the sensor's own axes in order"
        )
        return hit.acceleration_m_s2
    D = np.stack(
        [placement.direction(dof, point, RESPONSE, hit.origin) for dof in hit.responses], axis=1
    )
    R = placement.sensor_axes(point)
    n = D.shape[1]
    if np.allclose(D, R[:, :n], atol=1e-9):
        return hit.acceleration_m_s2
    if n != 3 or not np.allclose(D.T @ D, np.eye(3), atol=_ORTHOGONAL):
        raise ForeignFileError(
            f"{hit.origin}: wanted three perpendicular responses at point {point} (its sensor's "
            f"axes differ from the file's), got {n} that are not; give FRFs, or a point of its own"
        )
    # a = D a_file in base, and a_sensor = R^T a.
    turned: npt.NDArray[np.float64] = R.T @ D @ hit.acceleration_m_s2
    return turned


def pretrigger(signals: npt.NDArray[np.float64]) -> int:
    """Return the sample at which the force first reaches a twentieth of its peak."""
    return pulse_onset(signals[0] - np.median(signals[0]))


def foreign_dictionary(hits: Sequence[PlacedHit]) -> BoardDictionary:
    """Return the channels of imported hits (or, without any, of imported FRFs).

    Raises
    ------
    ForeignFileError
        If hits differ in sampling rate.
    """
    _check_alike(hits)
    n_axes = hits[0].signals.shape[0] - 1 if hits else 3
    largest = np.ones(1 + n_axes)
    if hits:
        largest = np.max([np.abs(hit.signals).max(axis=1) for hit in hits], axis=0)
        largest = np.where(largest > 0.0, largest, 1.0)
    names = ["force", *(f"acceleration_{axis}" for axis in AXES[:n_axes])]
    return BoardDictionary(
        board_id="imported",
        firmware="none",
        link_bytes_per_s=1,
        block_capacity=1,
        tick_hz=1,
        filter_group_delay_samples=0.0,
        channels=tuple(
            Channel(
                name=name,
                quantity="acceleration" if i else "force",
                unit="m/s^2" if i else "N",
                scale=float(largest[i]) / _COUNTS,
                full_scale=2.0 * float(largest[i]),
                iepe=IepeState.OFF,
                highpass_hz=0.0,
                serial_number="",
                calibration_date="",
                teds=b"",
            )
            for i, name in enumerate(names)
        ),
    )


def _check_alike(hits: Sequence[PlacedHit]) -> None:
    for hit in hits:
        if abs(float(hit.rate_hz / hits[0].rate_hz) - 1.0) >= _SAME_RATE:
            raise ForeignFileError(
                f"{hit.origin}: wanted samples at {float(hits[0].rate_hz):g} Hz like "
                f"{hits[0].origin}, got {float(hit.rate_hz):g} Hz; import them as a session of "
                "their own"
            )


def hit_records(hits: Sequence[PlacedHit], dictionary: BoardDictionary) -> tuple[Hit, ...]:
    """Return the hits of a session, not yet judged, in counts of the dictionary's channels."""
    scale = np.array([channel.scale for channel in dictionary.channels])
    records: list[Hit] = []
    first = 0
    for i, hit in enumerate(hits):
        counts = np.rint(hit.signals.T / scale)
        reading = JointReading(
            joints_rad=hit.joints_rad, drive_state=None, held=True, age_s=0.0, host_s=float(i)
        )
        verdict = Verdict(
            accepted=True,
            reasons=(),
            notes=(f"imported from {hit.origin[:200]}",),
            peak_n=float(np.max(np.abs(hit.signals[0]))),
            width_s=float("nan"),
            polarity=pulse_polarity(hit.signals[0]),
        )
        records.append(
            Hit(
                number=i + 1,
                posture=hit.posture,
                sensor_point=hit.sensor_point,
                hit_point=hit.hit_point,
                hit_direction=hit.hit_direction,
                first_sample=first,
                trigger_sample=first + pretrigger(hit.signals),
                trigger_host_s=float(i),
                counts=frozen_array(counts, np.int32),
                before=reading,
                after=reading,
                verdict=verdict,
            )
        )
        first += hit.signals.shape[1]
    return tuple(records)
