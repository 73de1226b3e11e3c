"""FRFs of a session on Laplace lines far enough from the poles that a fit finds its way.

On s = sigma + j w with a large sigma every resonance is broad, so that a model whose frequencies
are off by their width still sees where to go; with a small sigma the fit is sharp. Hits of our own
are transformed anew for each sigma (an exponential window alike on force and response, exact);
FRFs that were averaged elsewhere go through time: h(t) e^(-d t) has the transform H(s + d).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap.model.ends_of_records import noise_at_ends
from armodal.analyzer.gap.model.hit_levels import (
    has_levels,
    postures_hit_once,
    soft_and_hard,
    weight_factors,
)
from armodal.analyzer.gap.model.impulses import IMPULSE_OF_SINE, impulse_n_s
from armodal.analyzer.gap.model.moved_frfs import moved_frfs
from armodal.analyzer.given_frfs import complete_points
from armodal.analyzer.modal.frf import posture_frf
from armodal.analyzer.modal.noise import smooth_lines
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.plan_records import KnownMass
from armodal.protocols.session.records import Hit, Session

__all__ = [
    "Annealing",
    "PostureLines",
    "own_lines",
    "scatter",
    "shifted_lines",
]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complexfloating[Any, Any]]

_FEWEST = 4  # lines of a posture
_LEAD = 24  # samples kept before the trigger, for the offset and the noise
_SMOOTHED = 2  # lines to each side
_ALONG = 0.99  # cosine: hits along one direction


@dataclass(frozen=True, slots=True, kw_only=True)
class Annealing:
    """A stage of the fit: distance of the lines from the poles, their spacing, their band."""

    sigma_rad_s: float
    step_hz: float
    band_hz: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureLines:
    """A posture's accelerance on the lines of one stage, one mounting a row.

    A mounting is one sensor point with one hit; its three channels are the sensor's axes.
    """

    name: str
    joints_rad: Array  # (n_joints,) as read
    s_rad_s: ComplexArray  # (n_lines,)
    sensor_point: npt.NDArray[np.int64]  # (n_mountings,) index into the arm's points
    hit: npt.NDArray[np.int64]  # (n_mountings,) index into the hits below
    hit_point: npt.NDArray[np.int64]  # (n_hits,)
    hit_direction: Array  # (n_hits, 3) base frame
    values: ComplexArray  # (n_mountings, 3, n_lines) m/(N s^2)
    variance: Array  # (n_mountings, 3, n_lines): E|error of values|^2
    sensor_mass_kg: float
    peak_n: float = 0.0  # geometric mean of these hits' peak forces; 0: unknown
    level: float = 0.0  # ln of these hits' peak force, from the middle of all
    brakes: bool = False  # on
    known_mass: KnownMass | None = None  # bolted on
    # (n_mountings,) geometric mean of the peaks of the hits of each, N, were all half sines of one
    # width with their impulse; where hits are known.
    peaks_n: Array = field(default_factory=lambda: np.zeros(0))
    width_s: float = 0.0

    @property
    def key(self) -> tuple[object, ...]:
        """Return what tells these lines from a session's others."""
        where = (self.sensor_point, self.hit, self.hit_point, self.hit_direction, self.s_rad_s)
        return self.name, self.level, *(own.tobytes() for own in where)

    def is_hit_as(self, other: PostureLines) -> bool:
        """Return whether only values, their variance and the hits' level may differ."""
        plain = ("name", "brakes", "sensor_mass_kg")
        arrays = ("joints_rad", "s_rad_s", "sensor_point", "hit", "hit_point", "hit_direction")
        return (
            self.known_mass is other.known_mass
            and all(getattr(self, name) == getattr(other, name) for name in plain)
            and all(np.array_equal(getattr(self, name), getattr(other, name)) for name in arrays)
        )

    @property
    def hammer_roves(self) -> bool:
        """Return whether the hammer goes from point to point, rather than the sensor."""
        return len(set(self.hit_point.tolist())) > len(set(self.sensor_point.tolist()))

    @property
    def moved_point(self) -> npt.NDArray[np.int64]:
        """Return (n_mountings,) the point where what goes round, sensor or hammer, was."""
        return self.hit_point[self.hit] if self.hammer_roves else self.sensor_point

    @property
    def still_point(self) -> npt.NDArray[np.int64]:
        """Return (n_mountings,) the point where the other of both was."""
        return self.sensor_point if self.hammer_roves else self.hit_point[self.hit]

    @property
    def title(self) -> str:
        """Return the posture, what was done to the arm, and which hits where that matters."""
        words = [self.name]
        if self.brakes:
            words.append("brakes on")
        if self.known_mass is not None:
            words.append(f"{self.known_mass.mass_kg:.1f} kg on {self.known_mass.link}")
        if self.level != 0.0:
            words.append("soft hits" if self.level < 0.0 else "hard hits")
        return ", ".join(words)


def own_lines(
    superset: Superset, session: Session, stage: Annealing, *, level_about: float | None = None
) -> tuple[PostureLines, ...]:
    """Lines of every posture of a session with records of its own hits.

    Parameters
    ----------
    level_about
        Lines of every posture twice: of its soft and of its hard hits, their levels about this
        ln of a peak force (`hit_levels.middle_level`). Half of their difference
        counts as variance: single hits are badly aimed, and a spring of one stiffness a level is
        only nearly what depends on the level at every moment.

    Raises
    ------
    EstimateError
        If a posture has no joint angles, or a point lacks one of its three axes.
    """
    hits = [hit for hit in session.hits if hit.verdict.accepted]
    if level_about is None:
        all_hits = _lines_of(superset, session, hits, stage, level=0.0)
        if has_levels(session):
            return _widened(superset, all_hits, hits)
        once = postures_hit_once(hits)
        return tuple(
            _hit_once(session, own, _hits_of(superset, own, hits)) if own.name in once else own
            for own in all_hits
        )
    groups = soft_and_hard(_of_one_length(hits))
    return _lines_at_levels(superset, session, stage, groups, level_about)


def _lines_at_levels(
    superset: Superset,
    session: Session,
    stage: Annealing,
    groups: Sequence[Sequence[Hit]],
    level_about: float,
) -> tuple[PostureLines, ...]:
    """Lines of every posture once for each group of hits; how far they differ is variance too."""
    sets = [
        _lines_of(superset, session, own, stage, level=_mean_level(own) - level_about)
        for own in groups
    ]
    result: list[PostureLines] = []
    for of_posture in zip(*sets, strict=True):
        more = scatter([own.values for own in of_posture])
        result += [replace(own, variance=own.variance + more) for own in of_posture]
    return tuple(result)


def _of_one_length(hits: Sequence[Hit]) -> list[Hit]:
    """Records of each posture cut alike before and behind the trigger: their lines are the same."""
    leads: dict[str, int] = {}
    behinds: dict[str, int] = {}
    for hit in hits:
        lead = int(hit.trigger_sample - hit.first_sample)
        leads[hit.posture] = min(lead, leads.get(hit.posture, lead))
        behind = len(hit.counts) - lead
        behinds[hit.posture] = min(behind, behinds.get(hit.posture, behind))
    found = []
    for hit in hits:
        first = int(hit.trigger_sample - hit.first_sample) - leads[hit.posture]
        kept = hit.counts[first : first + leads[hit.posture] + behinds[hit.posture]]
        found.append(replace(hit, counts=kept, first_sample=hit.first_sample + first))
    return found


def _mean_level(hits: Sequence[Hit]) -> float:
    return float(np.mean([np.log(hit.verdict.peak_n) for hit in hits]))


def scatter(values: Sequence[ComplexArray]) -> Array:
    """Variance (..., n_lines) of each of several about their mean, smoothed."""
    power = np.var(np.stack(values), axis=0, ddof=1)
    return smooth_lines(power, _SMOOTHED)


def _hit_once(
    session: Session, lines: PostureLines, of_mountings: Sequence[Sequence[Hit]]
) -> PostureLines:
    """Lines of single hits with the noise that their records' ends tell beside what is known."""
    alone = [i for i, hits in enumerate(of_mountings) if len(hits) == 1]
    noise = noise_at_ends(
        session, [_from_the_hit(of_mountings[i][0]) for i in alone], lines.s_rad_s
    )
    variance = lines.variance.copy()
    variance[alone] += noise
    return replace(lines, variance=variance)


def _widened(
    superset: Superset, of_postures: Sequence[PostureLines], hits: Sequence[Hit]
) -> tuple[PostureLines, ...]:
    """Lines whose variance allows for one hit outweighing the others."""
    factor_of = weight_factors(hits)
    ids = [point.id for point in superset.arm.points]
    result = []
    for lines in of_postures:
        factors = np.array(
            [
                factor_of[lines.name, ids[point], ids[hit_point]]
                for point, hit_point in zip(
                    lines.sensor_point, lines.hit_point[lines.hit], strict=True
                )
            ]
        )
        result.append(replace(lines, variance=lines.variance * factors[:, None, None]))
    return tuple(result)


def _lines_of(
    superset: Superset, session: Session, chosen: Sequence[Hit], stage: Annealing, *, level: float
) -> tuple[PostureLines, ...]:
    plan = session.header.plan
    hits = tuple(_from_the_hit(hit) for hit in chosen)
    duration = max((len(hit.counts) for hit in hits), default=0) / float(plan.sampling.rate_hz)
    windows = replace(plan.windows, exponential_end=float(np.exp(-stage.sigma_rad_s * duration)))
    header = replace(session.header, plan=replace(plan, windows=windows))
    changed = replace(session, header=header, hits=hits)
    result = []
    for name in dict.fromkeys(hit.posture for hit in chosen):
        joints_rad = _joints(session, name)  # of all its hits: soft and hard share what they can
        dynamics = superset.posture(joints_rad)

        def axes(point: str, rotation: Array = dynamics.point_rotation) -> Array:
            return np.asarray(rotation[superset.point_index[point]])

        frf = posture_frf(changed, name, axes, band_hz=_padded(stage.band_hz))
        posed = replace(frf, joints_rad=joints_rad)
        lines = _thinned(superset, posed, stage, plan.sensor.mass_kg)
        own = [hit for hit in chosen if hit.posture == name]
        widths = np.array([hit.verdict.width_s for hit in own])
        width_s = float(np.median(widths)) if np.all(widths > 0.0) else 0.0
        result.append(
            replace(
                lines,
                level=level,
                peak_n=float(np.exp(_mean_level(chosen))),
                peaks_n=_peaks_n(session, _hits_of(superset, lines, own), width_s),
                width_s=width_s,
            )
        )
    return tuple(result)


def _hits_of(superset: Superset, lines: PostureLines, hits: Sequence[Hit]) -> list[list[Hit]]:
    """Those of each mounting, of hits of any postures."""
    found = []
    ids = [point.id for point in superset.arm.points]
    here = [hit for hit in hits if hit.posture == lines.name]
    for sensor, at in zip(lines.sensor_point, lines.hit, strict=True):
        where, direction = ids[lines.hit_point[at]], lines.hit_direction[at]
        own = [hit for hit in here if (hit.sensor_point, hit.hit_point) == (ids[sensor], where)]
        found.append([hit for hit in own if hit.hit_direction @ direction > _ALONG] or own)
    return found


def _peaks_n(session: Session, of_mountings: Sequence[Sequence[Hit]], width_s: float) -> Array:
    """(n_mountings,) peaks of the hits of each mounting, geometric means weighed by power.

    Of half sines of one width, with the impulse of the hits' own: that is what moves a joint. One
    place is hit anew for every mounting, by a hand that is never the same. An average of hits
    counts each by its force's power (H1), so it is the answer to a harder hit than their mean.
    """
    found = []
    for hits in of_mountings:
        if width_s:
            peaks = [impulse_n_s(session, hit) / (IMPULSE_OF_SINE * width_s) for hit in hits]
        else:
            peaks = [hit.verdict.peak_n for hit in hits]
        found.append(float(np.exp(np.average(np.log(peaks), weights=np.square(peaks)))))
    return np.array(found)


def shifted_lines(
    superset: Superset,
    frfs: Sequence[FrequencyResponse],
    stage: Annealing,
    *,
    sensor_mass_kg: float,
) -> tuple[PostureLines, ...]:
    """Lines of FRFs that were averaged elsewhere, moved through the time domain.

    Variance is moved as white noise in time is: it falls as the window's energy does.
    """
    return tuple(
        _thinned(superset, moved_frfs(frf, stage.sigma_rad_s), stage, sensor_mass_kg)
        for frf in frfs
    )


def _from_the_hit(hit: Hit) -> Hit:
    """The hit without most of its lead: a strong window would weigh its noise above the answer."""
    cut = max(int(hit.trigger_sample - hit.first_sample) - _LEAD, 0)
    return replace(hit, counts=hit.counts[cut:], first_sample=hit.first_sample + cut)


def _padded(band_hz: tuple[float, float]) -> tuple[float, float]:
    return 0.9 * band_hz[0], 1.1 * band_hz[1]


def _joints(session: Session, name: str) -> Array:
    angles = [
        reading.joints_rad
        for hit in session.accepted(name)
        for reading in (hit.before, hit.after)
        if reading.joints_rad is not None
    ]
    if not angles:
        raise EstimateError(
            f"posture '{name}' has no measured joint angles, so no model can be set beside it; "
            "measure it with the controller's angles on the bus"
        )
    return np.asarray(np.mean(angles, axis=0))


def _thinned(
    superset: Superset, frf: FrequencyResponse, stage: Annealing, sensor_mass_kg: float
) -> PostureLines:
    """Every posture's rows by mounting, and about every `step_hz` one line."""
    frf = complete_points(frf)
    if frf.joints_rad is None:
        raise EstimateError(
            f"posture '{frf.posture}' has no measured joint angles, so no model can be set beside "
            "it; measure it with the controller's angles on the bus"
        )
    step = float(np.median(np.diff(frf.freq_hz)))
    inside = np.flatnonzero((frf.freq_hz >= stage.band_hz[0]) & (frf.freq_hz <= stage.band_hz[1]))
    # A narrow band has the fewest lines nearer to each other.
    lines = inside[:: max(min(round(stage.step_hz / step), (inside.size - 1) // _FEWEST), 1)]
    if lines.size < _FEWEST:
        raise EstimateError(
            f"posture '{frf.posture}': wanted lines between {stage.band_hz[0]:.0f} and "
            f"{stage.band_hz[1]:.0f} Hz, got {lines.size}; measure that band"
        )
    points = list(dict.fromkeys(dof.point for dof in frf.responses))
    rows = {(dof.point, dof.label): i for i, dof in enumerate(frf.responses)}
    missing = [f"{p}{a}" for p in points for a in "xyz" if (p, a) not in rows]
    if missing:
        raise EstimateError(
            f"posture '{frf.posture}' lacks the responses {', '.join(missing[:4])}; a triaxial "
            "sensor gives x, y and z at each point"
        )
    order = np.array([[rows[p, a] for a in "xyz"] for p in points])
    n_hits = len(frf.references)
    values = frf.values[order][..., lines]  # (points, 3, hits, lines)
    variance = frf.variance[order][..., lines]
    dynamics = superset.posture(frf.joints_rad)
    sensor = np.array([superset.point_index[p] for p in points])
    directions = np.array([[frf.responses[i].direction for i in row] for row in order])
    turn = np.einsum("mji,mkj->mik", dynamics.point_rotation[sensor], directions)
    values = np.einsum("mij,mjrl->mirl", turn, values)
    variance = np.einsum("mij,mjrl->mirl", turn**2, variance)
    shape = (-1, 3, lines.size)
    return PostureLines(
        name=frf.posture,
        joints_rad=frf.joints_rad,
        s_rad_s=frf.decay_rad_s + 2j * np.pi * frf.freq_hz[lines],
        sensor_point=np.repeat(sensor, n_hits),
        hit=np.tile(np.arange(n_hits), len(points)),
        hit_point=np.array([superset.point_index[dof.point] for dof in frf.references]),
        hit_direction=np.array([dof.direction for dof in frf.references]),
        values=np.moveaxis(values, 2, 1).reshape(shape),
        variance=np.moveaxis(variance, 2, 1).reshape(shape),
        sensor_mass_kg=sensor_mass_kg,
    )
