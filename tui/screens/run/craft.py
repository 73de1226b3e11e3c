"""What the hits so far say about the craft: hammer tip, driving point, drift, scatter."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from armodal.analyzer.checks import driving_point
from armodal.analyzer.checks.records import Finding, Outcome
from armodal.analyzer.modal.spectra import hit_spectra
from armodal.analyzer.modal.usable_band import UsableBand
from armodal.protocols.errors import ArmodalError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Hit
from armodal.tui.screens.run.measured import PointFrf, session_of_hits
from armodal.tui.screens.run.overview import all_hits, counts_accepted, roving_place
from armodal.tui.screens.run.resonances import Resonance, resonances
from armodal.tui.screens.run.state import RunState

__all__ = [
    "Moved",
    "Scatter",
    "check_driving_point",
    "excited_band",
    "good_hit_before",
    "place_before",
    "resonance_moved",
    "scatter_at_resonance",
]

FEWEST_HITS = 2  # one hit tells nothing of its scatter


@dataclass(frozen=True, slots=True, kw_only=True)
class Moved:
    """The resonance that moved most from one point to the next, in its own half widths."""

    before_hz: float
    now_hz: float
    half_width_hz: float  # the wider of the two

    @property
    def clear(self) -> bool:
        """Whether it moved out of its own width: a neighbour's flank does not shift a peak so."""
        return abs(self.now_hz - self.before_hz) > self.half_width_hz


@dataclass(frozen=True, slots=True, kw_only=True)
class Scatter:
    """Standard deviation of the averaged FRF's magnitude at its strongest resonance."""

    f_hz: float
    relative_std: float
    n_hits: int

    def after(self, n_hits: int) -> float:
        """Relative standard deviation that a mean of so many hits of this scatter will have.

        >>> Scatter(f_hz=20.0, relative_std=0.02, n_hits=2).after(8)
        0.01
        """
        return float(self.relative_std * np.sqrt(self.n_hits / n_hits))

    def hits_for(self, relative_std: float) -> int:
        """How many hits of this scatter a mean needs for a relative standard deviation.

        >>> Scatter(f_hz=20.0, relative_std=0.02, n_hits=2).hits_for(0.01)
        8
        """
        return math.ceil(self.n_hits * (self.relative_std / relative_std) ** 2 - 1e-9)


def good_hit_before(state: RunState) -> Hit | None:
    """Return the accepted hit before the last one, wherever it was; None while there is none."""
    judged = state.last_hit
    if judged is None:
        return None
    before = all_hits(state)[:-1]
    return next((hit for hit in reversed(before) if counts_accepted(state, hit)), None)


def excited_band(state: RunState, hit: Hit) -> UsableBand | None:
    """Return the band that one hit excites, as the analysis takes it; None if it cannot tell."""
    session = session_of_hits(state, (hit,))
    if session is None or not hit.verdict.accepted:
        return None
    try:
        return hit_spectra(session, (hit,)).usable
    except ArmodalError:
        # A record from which no spectrum can be made; the verdict has said what is wrong.
        return None


def check_driving_point(found: PointFrf) -> Finding | None:
    """Return what the FRF says where hammer and sensor are at one point; None elsewhere."""
    frf = found.frf
    here = [i for i, dof in enumerate(frf.references) if dof.point == found.point]
    if not here or all(dof.point != found.point for dof in frf.responses):
        return None
    finding = driving_point(frf, here[0])
    return None if finding.outcome is Outcome.CANNOT_TELL else finding


def place_before(state: RunState, here: tuple[str, str]) -> tuple[str, str] | None:
    """Return the place of the same posture that last got an accepted hit, other than this one."""
    places = (
        roving_place(state, hit) for hit in reversed(all_hits(state)) if counts_accepted(state, hit)
    )
    return next((place for place in places if place[0] == here[0] and place != here), None)


def resonance_moved(before: FrequencyResponse, now: FrequencyResponse) -> Moved | None:
    """Return the resonance that moved most between two points; None if they share none.

    A resonance of both is a pair of peaks of which each is the other's nearest.
    """
    old = resonances(before)
    new = resonances(now)
    moved = [
        Moved(
            before_hz=a.f_hz,
            now_hz=b.f_hz,
            half_width_hz=max(a.half_width_hz, b.half_width_hz),
        )
        for a in old
        for b in new
        if b is _nearest(new, a) and a is _nearest(old, b)
    ]
    by_width = sorted(moved, key=lambda m: abs(m.now_hz - m.before_hz) / m.half_width_hz)
    return by_width[-1] if by_width else None


def _nearest(peaks: tuple[Resonance, ...], to: Resonance) -> Resonance:
    return min(peaks, key=lambda peak: abs(peak.f_hz - to.f_hz))


def scatter_at_resonance(found: PointFrf) -> Scatter | None:
    """Return the scatter at the strongest resonance; None with one hit, or no resonance.

    References
    ----------
    Bendat and Piersol, Random Data, 4th ed. (2010), section 9.2: half of the variance of a complex
    estimate lies along it, and shows in its magnitude.
    """
    frf = found.frf
    lines = [peak.line for peak in resonances(frf)]
    if found.n_hits < FEWEST_HITS or not lines:
        return None
    size = np.abs(frf.values[:, 0, lines])
    row, column = np.unravel_index(int(np.argmax(size)), size.shape)
    line = lines[int(column)]
    return Scatter(
        f_hz=float(frf.freq_hz[line]),
        relative_std=float(np.sqrt(frf.variance[row, 0, line] / 2.0) / size[row, column]),
        n_hits=found.n_hits,
    )
