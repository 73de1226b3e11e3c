"""Candidate poles from a stabilisation diagram, without a starting guess.

A physical pole comes back at nearly the same place at every order; one the noise asked for does
not. Poles are counted within a small radius in the complex plane (frequency and damping at once,
and participation where there are several references), the densest place is taken, one pole an
order is removed with it, and so on. The candidates are generous: the fit decides afterwards which
of them the data need.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.plscf import Stabilisation

__all__ = ["candidate_poles", "merge_duplicates", "physical", "zoom_bands"]

MOST_DAMPING = 0.25
LEAST_DAMPING = 1e-5
_RADIUS_OF_BANDWIDTH = 0.3  # of the half bandwidth |Re p|: a pole scatters in proportion to it
_RADIUS_LEAST = 0.001  # of |pole|, added
_RADIUS_MOST = 0.01  # of |pole|
_LEAST_PARTICIPATION_MAC = 0.8
_LEAST_SHARE = 0.25  # of the orders at which a pole must be present
_ZOOM_RATIO = 3.0  # highest over lowest frequency of a zoomed band
_ZOOM_STEP = 2.0  # between the starts of neighbouring bands, so that they overlap
_ZOOM_LEAST_LINES = 24


def zoom_bands(freq_hz: npt.NDArray[np.float64]) -> list[tuple[float, float]]:
    """Overlapping bands of a frequency ratio of three that cover the lines.

    One polynomial over a wide band resolves its low end poorly: a pole's share of the circle is
    its bandwidth over the band. A band too short of lines grows upwards until it holds enough.

    >>> zoom_bands(np.arange(1.0, 101.0))[0]
    (1.0, 24.0)
    """
    low, high = float(freq_hz[0]), float(freq_hz[-1])
    bands: list[tuple[float, float]] = []
    start, n = low, freq_hz.size
    while n > _ZOOM_LEAST_LINES:
        first = int(np.searchsorted(freq_hz, start))
        last = int(np.searchsorted(freq_hz, _ZOOM_RATIO * start, side="right")) - 1
        last = max(last, first + _ZOOM_LEAST_LINES - 1)
        if last >= n - 1:
            tail = max(min(first, n - _ZOOM_LEAST_LINES), 0)
            if tail > 0:
                bands.append((float(freq_hz[tail]), high))
            break
        bands.append((float(freq_hz[first]), float(freq_hz[last])))
        start = max(_ZOOM_STEP * start, float(freq_hz[last]) * _ZOOM_STEP / _ZOOM_RATIO)
    return bands


def physical(
    pole_rad_s: npt.NDArray[np.complex128], band_hz: tuple[float, float]
) -> npt.NDArray[np.bool_]:
    """Poles inside the band with a damping a structure can have."""
    magnitude = np.abs(pole_rad_s)
    damping = -pole_rad_s.real / np.maximum(magnitude, np.finfo(float).tiny)
    f = magnitude / (2.0 * np.pi)
    return (
        (damping > LEAST_DAMPING)
        & (damping < MOST_DAMPING)
        & (f > band_hz[0])
        & (f < band_hz[1])
        & (f > 0.0)
    )


def _radius(poles: npt.NDArray[np.complex128]) -> npt.NDArray[np.float64]:
    """How far two estimates of the same pole may lie apart, rad/s."""
    magnitude = np.abs(poles)
    radius = _RADIUS_OF_BANDWIDTH * np.abs(poles.real) + _RADIUS_LEAST * magnitude
    result: npt.NDArray[np.float64] = np.minimum(radius, _RADIUS_MOST * magnitude)
    return result


def candidate_poles(
    table: Stabilisation, band_hz: tuple[float, float]
) -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.float64]]:
    """Places where poles gather over the orders.

    Parameters
    ----------
    table
        Poles over orders.
    band_hz
        Band the frequencies must lie in.

    Returns
    -------
    poles, share
        (n,) complex median of each gathering in rad/s, sorted by frequency, and (n,) the share
        of orders it was seen at.
    """
    keep = physical(table.pole_rad_s, band_hz)
    pole, order, w = table.pole_rad_s[keep], table.order[keep], table.participation[keep]
    if pole.size == 0:
        return np.empty(0, dtype=np.complex128), np.empty(0)
    distance = np.abs(pole[:, None] - pole[None, :]) / _radius(pole)[:, None]
    near = distance < 1.0
    if w.shape[1] > 1:
        near &= np.abs(w.conj() @ w.T) ** 2 > _LEAST_PARTICIPATION_MAC
    alive = np.ones(pole.size, dtype=bool)
    closeness = np.where(near, 1.0 - distance, 0.0)
    wanted = max(3, int(np.ceil(_LEAST_SHARE * len(table.orders))))
    chosen: list[complex] = []
    share: list[float] = []
    while True:
        score = closeness[:, alive].sum(axis=1) * alive
        best = int(np.argmax(score))
        if score[best] <= 0.0:
            break
        members = np.flatnonzero(near[best] & alive)
        # One pole an order: the nearest.
        members = members[np.argsort(distance[best, members], kind="stable")]
        members = members[np.unique(order[members], return_index=True)[1]]
        alive[members] = False
        if members.size < wanted:
            if score[best] < 1.0 + 1e-9:
                break
            continue
        group = pole[members]
        chosen.append(complex(np.median(group.real), np.median(group.imag)))
        share.append(members.size / len(table.orders))
    rank = np.argsort(np.imag(chosen))
    return np.asarray(chosen, dtype=np.complex128)[rank], np.asarray(share)[rank]


def merge_duplicates(
    poles: npt.NDArray[np.complex128], share: npt.NDArray[np.float64]
) -> npt.NDArray[np.intp]:
    """Indices of the poles kept when any two within one radius are the same one.

    Of two the one seen at more orders stays.
    """
    kept: list[int] = []
    radius = _radius(poles)
    for i in np.argsort(-share, kind="stable"):
        if all(abs(poles[i] - poles[j]) > radius[j] for j in kept):
            kept.append(int(i))
    return np.sort(np.asarray(kept, dtype=np.intp))
