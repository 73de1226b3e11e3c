"""Windowed, coupling-corrected spectra of the single hits of a session."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.sensor_axes import axis_letter
from armodal.analyzer.modal.usable_band import UsableBand, usable_band
from armodal.analyzer.modal.windows import (
    exponential_decay,
    exponential_window,
    force_window,
    highpass_response,
    laplace_lines,
    undo_highpass,
)
from armodal.protocols.board.records import Channel
from armodal.protocols.errors import EstimateError
from armodal.protocols.force_pulse import pulse_onset
from armodal.protocols.session.records import Hit, Session

__all__ = ["HitSpectra", "active_channels", "fast_length", "hit_frfs", "hit_spectra"]

_LEAD_S = 0.002  # kept before the trigger: the foot of a pulse that rises slowly,
_LEAD_SAMPLES = 8  # and the ringing of an anti-alias filter of linear phase
_FEWEST_QUIET = (
    32  # samples before the trigger that tell a noise: fewer may be the filter's ringing
)


@dataclass(frozen=True, slots=True, kw_only=True)
class HitSpectra:
    """Windowed, coupling-corrected spectra of single hits on the lines s = decay + j w.

    The noise entries are the expected |noise|^2 of a line, from the samples before the trigger.
    `usable` is the band the hits excite, whatever band was asked for.
    """

    freq_hz: npt.NDArray[np.float64]  # (n_freq,)
    decay_rad_s: float
    force: npt.NDArray[np.complex128]  # (n_hits, n_freq) N s
    response: npt.NDArray[np.complex128]  # (n_hits, n_axes, n_freq) m/s, axes in order x, y, z
    force_noise: npt.NDArray[np.float64]  # (n_hits, n_freq)
    response_noise: npt.NDArray[np.float64]  # (n_hits, n_axes, n_freq)
    usable: UsableBand


def active_channels(session: Session) -> tuple[Channel, tuple[Channel, ...], list[int]]:
    """Force channel, acceleration channels, and their columns in the counts, force first.

    Acceleration channels come in the order of the letters their names end in: x, y, z.
    """
    header = session.header
    active = [c for i, c in enumerate(header.dictionary.channels) if header.channel_mask >> i & 1]
    force = [i for i, c in enumerate(active) if c.quantity == "force"]
    acceleration = sorted(
        (i for i, c in enumerate(active) if c.quantity == "acceleration"),
        key=lambda i: axis_letter(active[i]),
    )
    if len(force) != 1 or not acceleration:
        found = ", ".join(f"{c.name} ({c.quantity})" for c in active)
        raise EstimateError(
            "FRFs need one force channel and at least one acceleration channel among the "
            f"recorded ones; this session recorded {found or 'none'}"
        )
    columns = force + acceleration
    return active[force[0]], tuple(active[i] for i in acceleration), columns


def fast_length(most: int) -> int:
    """Length of at most so many samples whose Fourier transform is fast: 2^a 3^b 5^c.

    >>> fast_length(1024), fast_length(1023)
    (1024, 1000)
    """
    odd = [3**b * 5**c for b in range(most.bit_length()) for c in range(most.bit_length())]
    return int(max(each << (most // each).bit_length() - 1 for each in odd if each <= most))


def _check_records(hits: tuple[Hit, ...], n_channels: int) -> None:
    """Refuse a hit that lacks a channel, or holds less than half of what the longest does."""
    longest = max(len(hit.counts) for hit in hits)
    for hit in hits:
        n, recorded = hit.counts.shape
        if 2 * n < longest or recorded < n_channels:
            raise EstimateError(
                f"hit {hit.number} has {n} samples of {recorded} channels, wanted {n_channels} or "
                f"more channels, and at least half of the longest hit's {longest} samples; reject "
                "it or analyse it separately"
            )


def _trigger(hit: Hit, force: npt.NDArray[np.int32], *, rising: bool) -> int:
    """Sample of a hit's record at which its pulse begins."""
    trigger = int(hit.trigger_sample - hit.first_sample)
    if (hit.verdict.polarity > 0) == rising:
        return trigger
    # Against the trigger's slope the board triggers on what follows the pulse.
    return min(trigger, pulse_onset(force - np.median(force)))


def hit_spectra(
    session: Session, hits: tuple[Hit, ...], *, band_hz: tuple[float, float] | None = None
) -> HitSpectra:
    """Spectra of single hits, all at once.

    Records are cut to begin shortly before the trigger, and to a length quick to transform: what
    rings beyond the record's end then changes a mode's residue and not its pole
    (`docs/theory-modal.md`, section 1). Records of other lengths are cut to the shortest behind the
    trigger. The force of a reversed hammer is turned.

    Parameters
    ----------
    session
        Gives scales, coupling corners, sampling rate and windows.
    hits
        Hits, none shorter than half of the longest.
    band_hz
        Lines kept; by default the band the hits excite (`usable_band`).

    Returns
    -------
    HitSpectra
        On n_freq lines 1/T apart, T the length from shortly before the trigger.

    Raises
    ------
    EstimateError
        If there are no hits, one is far shorter, one has no force, or the band holds no line.
    """
    if not hits:
        raise EstimateError("FRFs need at least one accepted hit, got none; measure the posture")
    force_channel, acceleration_channels, columns = active_channels(session)
    _check_records(hits, max(columns) + 1)
    rate = float(session.header.plan.sampling.rate_hz)
    windows = session.header.plan.windows
    rising = session.header.plan.trigger.rising
    triggers = [_trigger(hit, hit.counts[:, columns[0]], rising=rising) for hit in hits]
    lead = min(_LEAD_SAMPLES + round(_LEAD_S * rate), *triggers)
    behind = min(len(hit.counts) - at for hit, at in zip(hits, triggers, strict=True))
    n = fast_length(behind + lead)
    decay = exponential_decay(windows.exponential_end, n / rate)

    channels = (force_channel, *acceleration_channels)
    scale = np.array([channel.scale for channel in channels])
    records = np.empty((len(hits), len(channels), n))
    variance = np.empty(records.shape[:2])
    for i, (hit, trigger) in enumerate(zip(hits, triggers, strict=True)):
        if not np.ptp(hit.counts[:, columns[0]]):
            raise EstimateError(
                f"hit {hit.number} of posture {hit.posture!r}: wanted a force, got none at "
                "all; see the hammer's cable, and reject the hit or measure it again"
            )
        record = hit.counts[:, columns].T * scale[:, None]
        record[0] *= hit.verdict.polarity
        # The last two samples before the trigger may already hold the pulse's foot.
        quiet = record[:, : max(trigger - 2, 2)]
        variance[i] = scale**2 / 12.0
        if quiet.shape[1] >= _FEWEST_QUIET:
            variance[i] = np.maximum(quiet.var(axis=1, ddof=1), variance[i])
        records[i] = (record - quiet.mean(axis=1, keepdims=True))[
            :, trigger - lead : trigger - lead + n
        ]

    exponential = exponential_window(n, rate, decay)
    force_weight = exponential
    coupled = list(channels)
    if windows.force_s is not None:
        records[:, 0] = undo_highpass(records[:, 0], rate, force_channel.highpass_hz)
        force_weight = exponential * force_window(n, rate, lead, windows.force_s)
    records[:, 0] *= force_weight
    records[:, 1:] *= exponential

    freq = np.arange(n // 2 + 1, dtype=np.float64) * (rate / n)
    spectra = np.fft.rfft(records, axis=-1) / rate
    noise_force = np.sum(force_weight**2) * variance[:, 0] / rate**2
    noise_response = np.sum(exponential**2) * variance[:, 1:] / rate**2

    usable = usable_band(freq, np.abs(spectra[:, 0]), rate)
    keep_lines = _band_lines(freq, band_hz or (usable.low_hz, usable.high_hz))
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
        usable=usable,
    )


def _band_lines(
    freq: npt.NDArray[np.float64], band_hz: tuple[float, float]
) -> npt.NDArray[np.bool_]:
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
