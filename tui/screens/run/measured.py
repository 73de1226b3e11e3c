"""What has been measured, in the form the analysis takes: for the pictures beside the verdict."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.frf import posture_frf
from armodal.analyzer.modal.spectra import hit_spectra
from armodal.analyzer.ratio_calibration import RatioCalibration, ratio_calibration
from armodal.daq.judge import channels_of, force_column
from armodal.protocols.arm.kinematics import link_pose
from armodal.protocols.board.records import Channel
from armodal.protocols.errors import ArmodalError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.progress import roving_point
from armodal.protocols.session.records import Hit, JointReading, Session, SessionHeader
from armodal.tui.screens.run.overview import all_hits, counts_accepted
from armodal.tui.screens.run.state import RunState

__all__ = ["LastPulse", "PointFrf", "last_pulse", "mass_ratio", "point_frf"]

Array = npt.NDArray[np.float64]
PULSE_WIDTHS = 6.0  # half widths shown on either side of the pulse
FEWEST_SAMPLES = 12
_NOBODY = JointReading(joints_rad=None, drive_state=None, held=False, age_s=0.0, host_s=0.0)
SHOWN_SHARE = 0.06  # of the peak: what the judge calls a second pulse


@dataclass(frozen=True, slots=True, kw_only=True)
class LastPulse:
    """The last pulse and its spectrum."""

    time_ms: Array  # (n,) from the trigger
    force_n: Array  # (n,)
    freq_hz: Array  # (n_freq,)
    spectrum_db: Array  # (n_freq,) of its maximum


@dataclass(frozen=True, slots=True, kw_only=True)
class PointFrf:
    """FRFs of one point so far."""

    point: str
    n_hits: int
    frf: FrequencyResponse  # what is drawn, with its phase and variance
    freq_hz: Array  # (n_freq,)
    magnitude_db: Array  # (n_axes, n_freq) re 1 m/s^2/N
    coherence: Array | None  # (n_freq,) the lowest of the axes; None with fewer than two hits
    axes: tuple[str, ...]


def active_channels(state: RunState) -> tuple[Channel, ...]:
    """Return the channels that are recorded; none before a board is found."""
    board = state.board
    return () if board is None else channels_of(board.dictionary, board.channel_mask)


def session_of_hits(state: RunState, hits: tuple[Hit, ...]) -> Session | None:
    """Return a session of some hits, for the analysis; None before a board is found."""
    board = state.board
    if board is None:
        return None
    header = SessionHeader(
        session_id="0",
        created="",
        software="",
        arm=state.arm,
        plan=state.plan,
        dictionary=board.dictionary,
        dictionary_bytes=b"",
        channel_mask=board.channel_mask,
        time_scale=state.time_scale,
    )
    return Session(header=header, hits=hits, losses=(), complete=False)


def mass_ratio(state: RunState) -> RatioCalibration | None:
    """Return what the good hits on the known mass say; None while there are none."""
    hits = tuple(
        Hit(
            number=i + 1,
            posture="",
            sensor_point="",
            hit_point="",
            hit_direction=np.array([0.0, 0.0, 1.0]),
            first_sample=trial.first_sample,
            trigger_sample=trial.trigger_sample,
            trigger_host_s=0.0,
            counts=trial.counts,
            before=_NOBODY,
            after=_NOBODY,
            verdict=trial.verdict,
        )
        for i, trial in enumerate(state.mass_hits)
        if trial.verdict.accepted
    )
    session = session_of_hits(state, hits)
    if state.mass_kg is None or not hits or session is None:
        return None
    try:
        return ratio_calibration(hit_spectra(session, hits), state.mass_kg)
    except ArmodalError:
        # Hits from which no spectrum can be made; more are asked for.
        return None


def last_pulse(state: RunState, hit: Hit) -> LastPulse | None:
    """Return the pulse of a hit with a little before and behind it, and its spectrum."""
    channels = active_channels(state)
    n = len(hit.counts)
    if not channels or n < FEWEST_SAMPLES:
        return None
    column = force_column(channels)
    rate_hz = float(state.plan.sampling.rate_hz)
    force_n = hit.counts[:, column] * np.float64(channels[column].scale)
    trigger = int(hit.trigger_sample - hit.first_sample)
    quiet = force_n[: max(trigger - 2, 1)]
    force_n = hit.verdict.polarity * (force_n - float(np.median(quiet)))
    width = hit.verdict.width_s
    half = int(PULSE_WIDTHS * (width if np.isfinite(width) else 0.0) * rate_hz)
    half = max(half, FEWEST_SAMPLES)
    peak = int(np.abs(force_n).argmax())
    # A second pulse is shown too, wherever it is.
    loud = np.flatnonzero(np.abs(force_n) > SHOWN_SHARE * np.abs(force_n[peak]))
    first = max(min(peak, int(loud[0])) - half, 0)
    last = min(max(peak + half, int(loud[-1])) + half, n)
    spectrum = np.abs(np.fft.rfft(force_n))
    floor = max(float(spectrum.max()), np.finfo(np.float64).tiny)
    freq = np.fft.rfftfreq(n, 1.0 / rate_hz)
    return LastPulse(
        time_ms=np.asarray(1e3 * (np.arange(first, last) - trigger) / rate_hz, dtype=np.float64),
        force_n=force_n[first:last],
        freq_hz=np.asarray(freq[1:], dtype=np.float64),
        spectrum_db=20.0 * np.log10(np.maximum(spectrum[1:] / floor, 1e-6)),
    )


def point_frf(state: RunState, here: tuple[str, str]) -> PointFrf | None:
    """Return FRFs of the accepted hits of one point of one posture; None while there are none."""
    hits = tuple(
        hit
        for hit in all_hits(state)
        if counts_accepted(state, hit) and (hit.posture, roving_point(state.plan, hit)) == here
    )
    session = session_of_hits(state, hits)
    if not hits or session is None:
        return None
    posture = next(p for p in state.plan.postures if p.name == here[0])

    def axes(point: str) -> Array:
        placed = state.arm.point(point)
        rotation: Array = link_pose(state.arm, placed.link, posture.joints_rad)[:3, :3]
        return rotation @ placed.R_link_sensor

    try:
        frf = posture_frf(session, here[0], axes)
    except ArmodalError:
        # A channel layout the analysis does not take; the report says why.
        return None
    several = len(hits) > 1
    return PointFrf(
        point=here[1],
        n_hits=len(hits),
        frf=frf,
        freq_hz=frf.freq_hz,
        magnitude_db=20.0 * np.log10(np.maximum(np.abs(frf.values[:, 0, :]), 1e-9)),
        coherence=frf.coherence[:, 0, :].min(axis=0) if several else None,
        axes=tuple(dof.label for dof in frf.responses),
    )
