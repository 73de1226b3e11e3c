"""Sensor faults put into simulated sessions, as cables, mountings and labels make them."""

from dataclasses import replace

import numpy as np

SWAP_XY = np.eye(3)[[1, 0, 2]]
TURN_Z90 = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
FLIP_X = np.diag([-1.0, 1.0, 1.0])
FLIP_Z = np.diag([1.0, 1.0, -1.0])


def gains(x=1.0, y=1.0, z=1.0):
    return np.diag([x, y, z])


def mixed(session, matrix, points=None):
    """Recorded axes = matrix @ true axes, at some points or (None) at all."""

    def fault(hit):
        if points is not None and hit.sensor_point not in points:
            return hit
        counts = hit.counts.astype(float)
        counts[:, 1:] = counts[:, 1:] @ matrix.T
        return replace(hit, counts=np.rint(counts).astype(np.int32))

    return replace(session, hits=tuple(fault(hit) for hit in session.hits))


def exchanged(session, a, b):
    """Hits of two points written down under each other's name."""
    names = {a: b, b: a}
    hits = (
        replace(h, sensor_point=names.get(h.sensor_point, h.sensor_point)) for h in session.hits
    )
    return replace(session, hits=tuple(hits))


def misplaced(session, other, said, truly):
    """Hits written down for one point, taken at another (in a second session of the same plan)."""
    fresh = {
        p.name: [h for h in other.hits if (h.posture, h.sensor_point) == (p.name, truly)]
        for p in session.header.plan.postures
    }

    def fault(hit):
        if hit.sensor_point != said or not fresh[hit.posture]:
            return hit
        return replace(fresh[hit.posture].pop(0), sensor_point=said, number=hit.number)

    return replace(session, hits=tuple(fault(hit) for hit in session.hits))
