"""Frequency responses of one posture from the accepted hits of a session."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analyzer.modal.noise import hit_scatter_variance, independent_line_share
from analyzer.modal.windows import (
    exponential_decay,
    exponential_window,
    force_window,
    highpass_response,
    laplace_lines,
    undo_highpass,
)
from protocols.arrays import frozen_array
from protocols.board.records import Channel
from protocols.errors import EstimateError
from protocols.frf_records import Dof, FrequencyResponse, FrfForm
from protocols.plan_records import Mode
from protocols.session.records import Hit, Session

__all__ = ["HitSpectra", "SensorAxes", "hit_frfs", "hit_spectra", "posture_frf"]

SensorAxes = Callable[[str], npt.NDArray[np.float64]] | Mapping[str, npt.NDArray[np.float64]]

_LOWEST_HZ = 3.0
_HIGHEST_OF_RATE = 0.39  # anti-alias filters of 24-bit boards are flat to about here
_LEAST_FORCE = 0.02  # of the force spectrum's maximum


@dataclass(frozen=True, slots=True, kw_only=True)
class HitSpectra:
    """Windowed, coupling-corrected spectra of single hits on the lines s = decay + j w.

    The noise entries are the expected |noise|^2 of a line, from the samples before the trigger.
    """

    freq_hz: npt.NDArray[np.float64]  # (n_freq,)
    decay_rad_s: float
    force: npt.NDArray[np.complex128]  # (n_hits, n_freq) N s
    response: npt.NDArray[np.complex128]  # (n_hits, 3, n_freq) m/s
    force_noise: npt.NDArray[np.float64]  # (n_hits, n_freq)
    response_noise: npt.NDArray[np.float64]  # (n_hits, 3, n_freq)


def _active_channels(session: Session) -> tuple[Channel, tuple[Channel, ...], list[int]]:
    """Force channel, acceleration channels, and their columns in the counts, force first."""
    header = session.header
    active = [c for i, c in enumerate(header.dictionary.channels) if header.channel_mask >> i & 1]
    force = [i for i, c in enumerate(active) if c.quantity == "force"]
    acceleration = [i for i, c in enumerate(active) if c.quantity == "acceleration"]
    if len(force) != 1 or not acceleration:
        found = ", ".join(f"{c.name} ({c.quantity})" for c in active)
        raise EstimateError(
            "FRFs need one force channel and at least one acceleration channel among the "
            f"recorded ones; this session recorded {found or 'none'}"
        )
    columns = force + acceleration
    return active[force[0]], tuple(active[i] for i in acceleration), columns


def _check_records(hits: tuple[Hit, ...], n_channels: int) -> int:
    """Length every record shares, or an error that names the hit that differs."""
    n_samples = hits[0].counts.shape[0]
    for hit in hits:
        if hit.counts.shape[0] != n_samples or hit.counts.shape[1] < n_channels:
            raise EstimateError(
                f"hit {hit.number} has counts of shape {hit.counts.shape}, wanted "
                f"({n_samples}, {n_channels} or more) like hit {hits[0].number}; "
                "reject it or analyse its block separately"
            )
    return int(n_samples)


def hit_spectra(
    session: Session, hits: tuple[Hit, ...], *, band_hz: tuple[float, float] | None = None
) -> HitSpectra:
    """Spectra of single hits, all at once.

    Parameters
    ----------
    session
        Gives scales, coupling corners, sampling rate and windows.
    hits
        Hits of equal length.
    band_hz
        Lines kept; by default 3 Hz to 0.39 of the sampling rate, cut where the median force
        spectrum first falls below 2 % of its maximum.

    Returns
    -------
    HitSpectra
        On n_freq lines 1/T apart, T the record's length.

    Raises
    ------
    EstimateError
        If there are no hits, their lengths differ, or the band holds no line.
    """
    if not hits:
        raise EstimateError("FRFs need at least one accepted hit, got none; measure the posture")
    force_channel, acceleration_channels, columns = _active_channels(session)
    n = _check_records(hits, max(columns) + 1)
    rate = float(session.header.plan.sampling.rate_hz)
    windows = session.header.plan.windows
    decay = exponential_decay(windows.exponential_end, n / rate)

    channels = (force_channel, *acceleration_channels)
    scale = np.array([channel.scale for channel in channels])
    records = np.stack([hit.counts[:, columns] for hit in hits]).transpose(0, 2, 1) * scale[:, None]
    triggers = [int(hit.trigger_sample - hit.first_sample) for hit in hits]
    variance = np.empty(records.shape[:2])
    for i, trigger in enumerate(triggers):
        # The last two samples before the trigger may already hold the pulse's foot.
        quiet = records[i, :, : max(trigger - 2, 2)]
        variance[i] = np.maximum(quiet.var(axis=1, ddof=1), scale**2 / 12.0)
        records[i] -= quiet.mean(axis=1, keepdims=True)

    exponential = exponential_window(n, rate, decay)
    force_weight = np.broadcast_to(exponential, (len(hits), n))
    coupled = list(channels)
    if windows.force_s is not None:
        records[:, 0] = undo_highpass(records[:, 0], rate, force_channel.highpass_hz)
        keep = np.stack([force_window(n, rate, trigger, windows.force_s) for trigger in triggers])
        force_weight = exponential * keep
    records[:, 0] *= force_weight
    records[:, 1:] *= exponential

    freq = np.arange(n // 2 + 1, dtype=np.float64) * (rate / n)
    spectra = np.fft.rfft(records, axis=-1) / rate
    noise_force = np.sum(force_weight**2, axis=-1) * variance[:, 0] / rate**2
    noise_response = np.sum(exponential**2) * variance[:, 1:] / rate**2

    keep_lines = _band_lines(freq, np.abs(spectra[:, 0]), rate, band_hz)
    freq = freq[keep_lines]
    s = laplace_lines(freq, decay)
    coupling = np.stack([highpass_response(s, c.highpass_hz) for c in coupled])
    if windows.force_s is not None:
        coupling[0] = 1.0
    spectra = spectra[..., keep_lines] / coupling
    gain = 1.0 / np.abs(coupling) ** 2
    return HitSpectra(
        freq_hz=freq,
        decay_rad_s=decay,
        force=spectra[:, 0],
        response=spectra[:, 1:],
        force_noise=noise_force[:, None] * gain[0],
        response_noise=noise_response[..., None] * gain[1:],
    )


def _band_lines(
    freq: npt.NDArray[np.float64],
    force: npt.NDArray[np.float64],
    rate: float,
    band_hz: tuple[float, float] | None,
) -> npt.NDArray[np.bool_]:
    """Lines to keep: the band asked for, or the one the force excites."""
    if band_hz is None:
        high = _HIGHEST_OF_RATE * rate
        typical = np.median(force, axis=0)
        weak = (typical < _LEAST_FORCE * typical.max()) & (freq > _LOWEST_HZ)
        if np.any(weak):
            high = min(high, float(freq[int(np.argmax(weak))]) * (1.0 - 1e-12))
        band_hz = (_LOWEST_HZ, high)
    low, high = band_hz
    keep = (freq >= low) & (freq <= high) & (freq > 0.0)
    if np.count_nonzero(keep) < 2:
        raise EstimateError(
            f"the band {low:g} to {high:g} Hz holds fewer than two of the lines "
            f"{freq[1]:g} Hz apart; widen it or record longer"
        )
    return keep


def hit_frfs(spectra: HitSpectra) -> npt.NDArray[np.complex128]:
    """Accelerance of every single hit: (n_hits, n_axes, n_freq), in the order of the hits."""
    return spectra.response / spectra.force[:, None, :]


def _axes(directions: SensorAxes, point: str) -> npt.NDArray[np.float64]:
    """Sensor axes at a point as columns, base frame."""
    try:
        axes = directions(point) if callable(directions) else directions[point]
    except KeyError as error:
        raise EstimateError(
            f"no sensor directions are known for point {point!r}; add the point to the arm file"
        ) from error
    axes = np.asarray(axes, dtype=np.float64)
    if axes.ndim != 2 or axes.shape[0] != 3:
        raise EstimateError(
            f"point {point!r}: wanted sensor axes as columns of a (3, n) array in the base frame, "
            f"got shape {axes.shape}"
        )
    return axes


def _labels(channels: tuple[Channel, ...]) -> tuple[str, ...]:
    """One letter an axis, from the channel names where they end in it."""
    named = tuple(channel.name[-1:].lower() for channel in channels)
    expected = ("x", "y", "z")[: len(channels)]
    return named if sorted(named) == sorted(expected) else expected


def posture_frf(
    session: Session,
    posture: str,
    directions: SensorAxes,
    *,
    band_hz: tuple[float, float] | None = None,
) -> FrequencyResponse:
    """H1 accelerance of one posture, averaged over the accepted hits of each point.

    Roving response: every axis of every sensor point is a response, the hit the one reference.
    Roving hammer: the axes of the fixed sensor are the responses, every hit point a reference.

    Parameters
    ----------
    session
        The measured session.
    posture
        Name of the posture.
    directions
        Per sensor point the sensor's axes in the base frame, columns of (3, 3): a function of
        the point's id, or a mapping.
    band_hz
        Lines kept; see `hit_spectra`.

    Returns
    -------
    FrequencyResponse
        Values in m/(N s^2) on s = decay + j w; coherence is 1 where there is one hit.

    Raises
    ------
    EstimateError
        If the posture has no accepted hits, or they cannot be one FRF matrix.

    References
    ----------
    H1 and coherence: Bendat and Piersol, Random Data, 4th ed. (2010), ch. 6. Window:
    `docs/theory-modal.md`.
    """
    hits = session.accepted(posture)
    if not hits:
        raise EstimateError(
            f"posture {posture!r} has no accepted hits in this session; measure it first"
        )
    roving_hammer = session.header.plan.mode is Mode.ROVING_HAMMER
    rover = [hit.hit_point if roving_hammer else hit.sensor_point for hit in hits]
    fixed = {hit.sensor_point if roving_hammer else hit.hit_point for hit in hits}
    if len(fixed) != 1:
        raise EstimateError(
            f"posture {posture!r}: one {'sensor' if roving_hammer else 'hit'} point is fixed in "
            f"{session.header.plan.mode.value}, the hits name {', '.join(sorted(fixed))}"
        )
    points = list(dict.fromkeys(rover))
    spectra = hit_spectra(session, hits, band_hz=band_hz)
    _, acceleration_channels, _ = _active_channels(session)
    labels = _labels(acceleration_channels)

    membership = np.array([[point == name for name in rover] for point in points], dtype=float)
    counts = membership.sum(axis=1).astype(np.int64)
    value, coherence, variance = _average(spectra, membership, counts)

    fixed_point = fixed.pop()
    first = {point: hits[rover.index(point)] for point in points}

    def sensor_dofs(point: str) -> list[Dof]:
        axes = _axes(directions, point)
        return [
            Dof(point=point, label=label, direction=frozen_array(axis, np.float64))
            for label, axis in zip(labels, axes.T, strict=True)
        ]

    def hit_dof(hit: Hit) -> Dof:
        direction = frozen_array(hit.hit_direction, np.float64)
        return Dof(point=hit.hit_point, label="hit", direction=direction)

    if roving_hammer:
        responses = sensor_dofs(fixed_point)
        references = [hit_dof(first[point]) for point in points]
        n_hits = np.broadcast_to(counts, (len(labels), len(points)))
        # (point, axis, line) to (axis, point, line)
        value, coherence = value.transpose(1, 0, 2), coherence.transpose(1, 0, 2)
        variance = variance.transpose(1, 0, 2)
    else:
        responses = [dof for point in points for dof in sensor_dofs(point)]
        references = [hit_dof(hits[0])]
        shape = (len(responses), 1, -1)
        n_hits = np.repeat(counts, len(labels))[:, None]
        value, coherence = value.reshape(shape), coherence.reshape(shape)
        variance = variance.reshape(shape)

    return FrequencyResponse(
        posture=posture,
        form=FrfForm.ACCELERANCE,
        freq_hz=frozen_array(spectra.freq_hz, np.float64),
        decay_rad_s=spectra.decay_rad_s,
        values=frozen_array(value, np.complex128),
        coherence=frozen_array(coherence, np.float64),
        variance=frozen_array(variance, np.float64),
        n_hits=frozen_array(n_hits, np.int64),
        responses=tuple(responses),
        references=tuple(references),
        joints_rad=_mean_joints(hits),
    )


def _average(
    spectra: HitSpectra, membership: npt.NDArray[np.float64], counts: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """H1, coherence and variance, each (n_points, n_axes, n_freq)."""
    F, X = spectra.force, spectra.response

    def total(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        result: npt.NDArray[np.float64] = np.tensordot(membership, values, axes=1)
        return result

    power_force = total(np.abs(F) ** 2)[:, None, :]
    power_response = total(np.abs(X) ** 2)
    cross = np.tensordot(membership, X * F.conj()[:, None, :], axes=1)
    value = cross / power_force
    coherence = np.clip(
        np.abs(cross) ** 2 / np.maximum(power_force * power_response, np.finfo(float).tiny),
        0.0,
        1.0,
    )
    own = value[np.argmax(membership, axis=0)]  # each hit's point
    residual = total(np.abs(X - own * F[:, None, :]) ** 2)
    several = np.maximum(counts - 1, 1)[:, None, None]
    scatter = residual / several / power_force
    mean_count = counts[:, None, None]
    floor = (
        total(spectra.response_noise) + np.abs(value) ** 2 * total(spectra.force_noise)[:, None, :]
    ) / (mean_count * power_force)
    independent = independent_line_share(
        spectra.decay_rad_s, float(spectra.freq_hz[1] - spectra.freq_hz[0])
    )
    n_hits = np.repeat(counts[:, None], X.shape[1], axis=1)
    variance = hit_scatter_variance(scatter, floor, np.abs(value) ** 2, n_hits, independent)
    return value, coherence, variance


def _mean_joints(hits: tuple[Hit, ...]) -> npt.NDArray[np.float64] | None:
    """Mean of the joint angles read before and after the hits; None where none was read."""
    readings = [
        reading.joints_rad
        for hit in hits
        for reading in (hit.before, hit.after)
        if reading.joints_rad is not None
    ]
    return frozen_array(np.mean(readings, axis=0), np.float64) if readings else None
