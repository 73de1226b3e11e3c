"""FRFs of a simulated session on Laplace lines, as the bystander of a case expects them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.session.records import Session

ComplexArray = npt.NDArray[np.complex128]


def laplace_frfs(session: Session, s: ComplexArray) -> ComplexArray:
    """H1 on the lines `s` in rad/s, (n_postures, n_points, 3, n_lines) in m/s² per N."""
    plan = session.header.plan
    t = np.arange(plan.sampling.samples) / float(plan.sampling.rate_hz)
    kernel = np.exp(-np.outer(t, s))
    scale = np.array([channel.scale for channel in session.header.dictionary.channels])
    points = plan.postures[0].points
    cross = np.zeros((len(plan.postures), len(points), 3, len(s)), dtype=np.complex128)
    power = np.zeros((*cross.shape[:2], 1, len(s)))
    order = {posture.name: i for i, posture in enumerate(plan.postures)}
    for hit in session.hits:
        i, j = order[hit.posture], points.index(hit.sensor_point)
        record = hit.counts * scale
        spectra = (record - record[: plan.sampling.pretrigger // 2].mean(axis=0)).T @ kernel
        cross[i, j] += spectra[1:] * np.conj(spectra[0])
        power[i, j] += np.abs(spectra[0]) ** 2
    return cross / power
