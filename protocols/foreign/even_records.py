"""Records of foreign hits made alike: as long behind their pulse, with as many channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.hit_records import PlacedHit, pretrigger
from armodal.protocols.foreign.hit_variables import MOST_TRIMMED

__all__ = ["trimmed", "with_even_axes"]

_LEAST_LENGTH = 0.5  # of the median length behind the pulse


def trimmed(hits: Sequence[PlacedHit], said: list[str]) -> list[PlacedHit]:
    """Cut records to the shortest, and say it; those below half of the usual are left out.

    Records a few samples apart are cut at their end, others so that all are as long behind their
    pulse.
    """
    lengths = [hit.signals.shape[1] for hit in hits]
    if len(set(lengths)) < 2:
        return list(hits)
    if max(lengths) - min(lengths) <= MOST_TRIMMED:
        n = min(lengths)
        said.append(f"records are {n} to {max(lengths)} samples long: the first {n} are used")
        return [_until(hit, n) for hit in hits]
    behind = [hit.signals.shape[1] - pretrigger(hit.signals) for hit in hits]
    least = _LEAST_LENGTH * float(np.median(behind))
    kept = [hit for hit, n in zip(hits, behind, strict=True) if n >= least]
    short = [hit.origin for hit, n in zip(hits, behind, strict=True) if n < least]
    if short:
        said.append(
            f"{len(short)} records are less than half as long as the others: left out "
            f"({', '.join(dict.fromkeys(short))})"[:400]
        )
    n = min(behind[i] for i, hit in enumerate(hits) if behind[i] >= least)
    if n < max(behind):
        said.append(
            f"records hold {n} to {max(behind)} samples behind their pulse: the first {n} are used"
        )
    return [_until(hit, pretrigger(hit.signals) + n) for hit in kept]


def _until(hit: PlacedHit, n: int) -> PlacedHit:
    return replace(hit, signals=frozen_array(hit.signals[:, :n], np.float64))


def with_even_axes(hits: Sequence[PlacedHit], said: list[str]) -> list[PlacedHit]:
    """Give every record the channels of the sensor with most axes; those not there are zero."""
    most = max((hit.signals.shape[0] for hit in hits), default=0)
    fewer = [hit for hit in hits if hit.signals.shape[0] < most]
    if not fewer:
        return list(hits)
    _check_axes(hits)
    points = dict.fromkeys(hit.sensor_point for hit in fewer)
    said.append(
        f"the sensors at {', '.join(points)} have fewer axes than others: their missing channels "
        "are stored as zeros and not used"
    )
    return [
        replace(
            hit,
            signals=frozen_array(
                np.pad(hit.signals, ((0, most - hit.signals.shape[0]), (0, 0))), np.float64
            ),
        )
        for hit in hits
    ]


def _check_axes(hits: Sequence[PlacedHit]) -> None:
    """Refuse a point at which hits have other numbers of axes."""
    first: dict[str, PlacedHit] = {}
    for hit in hits:
        one = first.setdefault(hit.sensor_point, hit)
        if hit.signals.shape[0] != one.signals.shape[0]:
            raise ForeignFileError(
                f"{hit.origin}: wanted {one.signals.shape[0]} channels at point "
                f"{hit.sensor_point} like {one.origin}, got {hit.signals.shape[0]}; name another "
                "point with `responses`, or import them as a session of their own"
            )
