"""FRFs of a session, one a posture."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.modal import band_of_hits, posture_frf
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session

__all__ = ["estimate_frfs"]


def estimate_frfs(
    session: Session, superset: Superset, *, band_hz: tuple[float, float] | None = None
) -> tuple[FrequencyResponse, ...]:
    """FRFs of every planned posture with accepted hits or given FRFs, in plan order.

    A band asked for widens the one that hits excite; `record_notes` says what that means.
    """
    frfs = []
    given = {frf.posture: frf for frf in session.frfs}
    for posture in session.header.plan.postures:
        if posture.name in given:
            frfs.append(given[posture.name])
            continue
        if not session.accepted(posture.name):
            continue
        measured = [
            reading.joints_rad
            for hit in session.accepted(posture.name)
            for reading in (hit.before, hit.after)
            if reading.joints_rad is not None
        ]
        rotation = superset.posture(np.mean(measured, axis=0)).point_rotation
        directions = {p: rotation[i] for p, i in superset.point_index.items()}
        usable = None if band_hz is None else band_of_hits(session, posture.name)
        widened = None if usable is None or band_hz is None else usable.widened(band_hz)
        frfs.append(posture_frf(session, posture.name, directions, band_hz=widened))
    return tuple(frfs)
