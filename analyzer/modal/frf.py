"""Frequency responses of one posture from the accepted hits of a session."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.chosen_hits import HitChoice, accepted_hits, choose_hits, hit_pairs
from armodal.analyzer.modal.estimators import single_reference
from armodal.analyzer.modal.hit_selection import coherence_of_all
from armodal.analyzer.modal.noise import (
    hit_scatter_variance,
    independent_line_share,
    line_to_line_noise,
)
from armodal.analyzer.modal.sensor_axes import sensor_axes
from armodal.analyzer.modal.spectra import HitSpectra, active_channels, hit_spectra
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import Dof, FrequencyResponse, FrfEstimator, FrfForm
from armodal.protocols.session.records import Hit, Session

__all__ = ["SensorAxes", "posture_frf"]

SensorAxes = Callable[[str], npt.NDArray[np.float64]] | Mapping[str, npt.NDArray[np.float64]]


def _axes(directions: SensorAxes, point: str) -> npt.NDArray[np.float64]:
    """All three sensor axes at a point as columns, base frame."""
    try:
        axes = directions(point) if callable(directions) else directions[point]
    except KeyError as error:
        raise EstimateError(
            f"no sensor directions are known for point {point!r}; add the point to the arm file"
        ) from error
    axes = np.asarray(axes, dtype=np.float64)
    if axes.shape != (3, 3):
        raise EstimateError(
            f"point {point!r}: wanted sensor axes as columns of a (3, 3) array in the base frame, "
            f"got shape {axes.shape}"
        )
    return axes


def posture_frf(
    session: Session,
    posture: str,
    directions: SensorAxes,
    *,
    band_hz: tuple[float, float] | None = None,
) -> FrequencyResponse:
    """Accelerance of one posture, averaged over the accepted hits of each point.

    Windows, estimator and the number of hits kept are those of the plan; hits unlike the others
    are left out (`hit_choices`).

    Every recorded axis of every sensor point is a response, in the order x, y, z; every hit point,
    and every direction hit there, is a reference. Roving response: many responses, one reference
    or a few. Roving hammer: the axes of the fixed sensor, many references.

    Parameters
    ----------
    session
        The measured session.
    posture
        Name of the posture.
    directions
        Per sensor point the sensor's axes x, y, z in the base frame, columns of (3, 3), also where
        fewer were recorded: a function of the point's id, or a mapping.
    band_hz
        Lines kept; see `hit_spectra`.

    Returns
    -------
    FrequencyResponse
        Values in m/(N s^2) on s = decay + j w; coherence is 1 where there is one hit.

    Raises
    ------
    EstimateError
        If the posture has no accepted hits, a sensor point was not hit from every reference, or
        the channels' names do not tell their axes.

    References
    ----------
    H1 and coherence: Bendat and Piersol, Random Data, 4th ed. (2010), ch. 6. Window:
    `docs/theory-modal.md`.
    """
    hits = accepted_hits(session, posture)
    pairs = hit_pairs(hits)
    points, references = pairs.points, pairs.references
    for pair, members in enumerate(pairs.members()):
        if not members.size:
            i, j = divmod(pair, len(references))
            raise EstimateError(
                f"posture {posture!r}: sensor point {points[i]} has no accepted hit at point "
                f"{references[j].point} along {np.round(references[j].direction, 3).tolist()}; "
                "one FRF matrix needs every sensor point hit from every reference: measure it, "
                "or analyse them separately"
            )
    spectra = hit_spectra(session, hits, band_hz=band_hz)
    axes = sensor_axes(active_channels(session)[1])
    averaging = session.header.plan.averaging
    choices = choose_hits(posture, hits, pairs, spectra, keep=averaging.keep_hits)
    numbers = np.array([hit.number for hit in hits])
    membership = np.array([np.isin(numbers, choice.kept) for choice in choices], dtype=float)
    counts = membership.sum(axis=1).astype(np.int64)
    columns = active_channels(session)[2][1:]
    there = _axes_there(hits, columns, membership)
    averages = _average(spectra, membership, choices, averaging.estimator, there)
    kept_rows = there.reshape(len(points), len(references), len(axes)).any(axis=1).reshape(-1)

    def matrix(per_pair: npt.NDArray[np.generic]) -> npt.NDArray[np.generic]:
        """(point x reference, axis, ...) to (point x axis, reference, ...)."""
        split = per_pair.reshape(len(points), len(references), *per_pair.shape[1:])
        swapped = split.swapaxes(1, 2)
        rows = swapped.reshape(len(points) * len(axes), len(references), *swapped.shape[3:])
        return rows[kept_rows]

    value, coherence, variance = (matrix(part) for part in averages)
    every = tuple(
        Dof(point=point, label="xyz"[axis], direction=frozen_array(columns[:, axis], np.float64))
        for point, columns in ((point, _axes(directions, point)) for point in points)
        for axis in axes
    )
    responses = tuple(dof for dof, is_kept in zip(every, kept_rows, strict=True) if is_kept)
    return FrequencyResponse(
        posture=posture,
        form=FrfForm.ACCELERANCE,
        freq_hz=frozen_array(spectra.freq_hz, np.float64),
        decay_rad_s=spectra.decay_rad_s,
        values=frozen_array(value, np.complex128),
        coherence=frozen_array(coherence, np.float64),
        variance=frozen_array(variance, np.float64),
        n_hits=frozen_array(matrix(np.repeat(counts[:, None], len(axes), axis=1)), np.int64),
        responses=responses,
        references=references,
        joints_rad=_mean_joints(hits),
    )


def _axes_there(
    hits: tuple[Hit, ...], columns: list[int], membership: npt.NDArray[np.float64]
) -> npt.NDArray[np.bool_]:
    """Whether a pair's hits have an axis, (n_pairs, n_axes): one without a count is none."""
    counted = np.array([hit.counts[:, columns].any(axis=0) for hit in hits])
    there: npt.NDArray[np.bool_] = (membership @ counted) > 0.0
    return there


def _average(
    spectra: HitSpectra,
    membership: npt.NDArray[np.float64],
    choices: tuple[HitChoice, ...],
    estimator: FrfEstimator,
    there: npt.NDArray[np.bool_],
) -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Estimate, coherence and variance, each (n_pairs, n_axes, n_freq).

    `membership` (n_pairs, n_hits) is 1 where a kept hit belongs to the pair, `there` (n_pairs,
    n_axes) whether an axis was measured.
    """
    kept = membership.any(axis=0)
    membership = membership[:, kept]
    F, X = spectra.force[kept], spectra.response[kept]
    counts = membership.sum(axis=1).astype(np.int64)

    def total(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        result: npt.NDArray[np.float64] = np.tensordot(membership, values, axes=1)
        return result

    power_force = total(np.abs(F) ** 2)[:, None, :]
    power_response = total(np.abs(X) ** 2)
    cross = np.tensordot(membership, X * F.conj()[:, None, :], axes=1)
    value, coherence = single_reference(estimator, power_force, power_response, cross)
    own = value[np.argmax(membership, axis=0)]  # each hit's pair of points
    residual = total(np.abs(X - own * F[:, None, :]) ** 2)
    several = np.maximum(counts - 1, 1)[:, None, None]
    scatter = residual / several / power_force
    mean_count = counts[:, None, None]
    floor = (
        total(spectra.response_noise[kept])
        + np.abs(value) ** 2 * total(spectra.force_noise[kept])[:, None, :]
    ) / (mean_count * power_force)
    spacing_hz = float(spectra.freq_hz[1] - spectra.freq_hz[0])
    independent = independent_line_share(spectra.decay_rad_s, spacing_hz)
    alone = counts == 1
    if np.any(alone):
        rough = line_to_line_noise(value[alone], spectra.decay_rad_s, spacing_hz)
        floor[alone] = np.maximum(floor[alone], rough)
    n_hits = np.repeat(counts[:, None], X.shape[1], axis=1)
    variance = np.zeros(value.shape)
    variance[there] = hit_scatter_variance(
        scatter[there][:, None],
        floor[there][:, None],
        (np.abs(value) ** 2)[there][:, None],
        n_hits[there][:, None],
        independent,
    )[:, 0]
    # Hits kept because they agree scatter less than hits do.
    widened = np.array([choice.variance_factor for choice in choices])[:, None, None]
    coherence = np.stack(
        [
            coherence_of_all(one, choice.scatter_factor)
            for one, choice in zip(coherence, choices, strict=True)
        ]
    )
    return value, coherence, variance * widened


def _mean_joints(hits: tuple[Hit, ...]) -> npt.NDArray[np.float64] | None:
    """Mean of the joint angles read before and after the hits; None where none was read."""
    readings = [
        reading.joints_rad
        for hit in hits
        for reading in (hit.before, hit.after)
        if reading.joints_rad is not None
    ]
    return frozen_array(np.mean(readings, axis=0), np.float64) if readings else None
