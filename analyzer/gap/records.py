"""What the gap workflow says: records that travel to the report, the screen and the arm file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

__all__ = [
    "Calibrated",
    "Disagreement",
    "EffectFound",
    "GapResult",
    "Gate",
    "Hidden",
    "Interval",
    "LineDeviation",
    "Misfit",
    "ModeMatch",
    "NextTest",
    "PostureGap",
    "RivalRow",
    "StiffnessRange",
    "Verdict",
]


class Verdict(StrEnum):
    """One of four."""

    NAMED = "named"
    AMBIGUOUS = "ambiguous"
    NOTHING_DETECTABLE = "nothing_detectable"
    OUTSIDE_LIBRARY = "outside_library"


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """A parameter with its standard deviation and 95 % interval."""

    unit: str  # empty for a pure number and for a logarithm
    value: float
    std: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LineDeviation:
    """How far a line may be turned and shifted, one deviation both ways across it together."""

    turned_rad: float
    shifted_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectFound:
    """An effect that was named and added."""

    name: str
    title: str
    place: str
    parameters: Mapping[str, Interval]
    size: str  # the parameter that says how large it is; empty for axes flipped or exchanged
    description: Mapping[str, object]  # direction and place of an axis, in the link's frame
    confidence: float  # that it is this and no other effect of the library, and no chance
    gain: float  # of evidence over the model without it, nats
    held_out_gain: float  # of log densities of postures, each foretold without itself, nats
    signature: str
    confused_with: tuple[str, ...]  # titles of effects
    told_by: str
    remedy: str
    # Of any effect of the library looking as clear on a session without one; None: not known.
    false_name_probability: float | None = None
    sizes: tuple[str, ...] = ()  # several of one unit: the largest says how large it is
    line: LineDeviation | None = None  # of the line that the description tells
    details: tuple[str, ...] = ()  # parameters of its form, which people are not told
    words: Mapping[str, str] = field(default_factory=dict)  # of parameters, where names do not do


@dataclass(frozen=True, slots=True, kw_only=True)
class RivalRow:
    """A rival of the last step, best first."""

    name: str
    title: str
    place: str
    gain: float  # of evidence over the model without it
    behind: float  # of the best
    standing: bool  # not yet refuted
    material: bool  # told to be large enough to be worth a name
    parameters: Mapping[str, Interval]
    told_by: str
    false_name_probability: float | None = None  # as of a named effect
    odds: float | None = None  # over the best, by evidence and what errors are worth
    line: LineDeviation | None = None
    details: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibrated:
    """Limits of evidence, read from replicas of the session."""

    accepted_false_name: float  # what the user accepts
    replicas: int
    limits: Mapping[str, float]  # nats of evidence by an effect's name
    limit_otherwise: float  # nats, of effects that no linear look tells
    tail: str  # how what is rarer than replicas tell was found
    dispersion: float  # variance of an effect's size over that of independent errors
    error_ratio: float  # of what the best model leaves, where effects feel it, over what is assumed


@dataclass(frozen=True, slots=True, kw_only=True)
class Misfit:
    """chi^2 per real residual of the last model, beside what replicas of it leave."""

    measured: float
    replicas_leave: float  # at most, but for as many as the accepted false names


@dataclass(frozen=True, slots=True, kw_only=True)
class Hidden:
    """How large an effect could be and still not be seen (95 %)."""

    name: str
    place: str
    parameter: str
    unit: str
    largest: float
    title: str = ""  # in words; older files lack it
    words: str = ""  # of the parameter, where its name does not do


@dataclass(frozen=True, slots=True, kw_only=True)
class StiffnessRange:
    """A joint's stiffness: k ± k_std of the best; low to high over all that still may be so."""

    joint: str
    k_n_m_per_rad: float  # of the best
    k_std: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeMatch:
    """A measured mode beside the model's, paired by shape."""

    measured_hz: float
    model_hz: float
    measured_damping_ratio: float
    model_damping_ratio: float
    mac: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PostureGap:
    """How far a model is from one posture's measurement."""

    posture: str
    held_out: bool  # not fitted to
    frf_error: float  # rms of the difference over rms of the FRFs, band as fitted
    floor: float  # the same of the measured scatter and the allowed discrepancy
    modes: tuple[ModeMatch, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Disagreement:
    """A cell of the map: 1 is what scatter and allowance explain."""

    posture: str
    point: str
    axis: str
    band_hz: tuple[float, float]
    ratio: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Gate:
    """What a check without a model said."""

    check: str
    outcome: str
    words: str


@dataclass(frozen=True, slots=True, kw_only=True)
class NextTest:
    """The test that would tell most about what is still open, as a plan to measure by."""

    words: str  # what to do, one sentence
    why: str  # what it would decide
    gain: float | None  # expected of evidence between what still stands, nats; None: not foretold
    plan_toml: str  # text of a plan file, docs/plan-file.md


@dataclass(frozen=True, slots=True, kw_only=True)
class GapResult:
    """The verdict and everything it stands on.

    Attributes
    ----------
    verdict : Verdict
        What was concluded.
    summary : str
        One sentence for the head of the laboratory.
    effects : tuple of EffectFound
        What was named, with sizes, evidence and remedy.
    rivals : tuple of RivalRow
        Those of the last step, best first.
    hidden : tuple of Hidden
        How large each other effect may be and still not be seen, 95 %.
    joint_stiffness_ranges : tuple of StiffnessRange
        k of each joint over all that still may be so, N m/rad.
    gap_before, gap_after : tuple of PostureGap
        Distance of model and measurement, posture by posture: of the plain model, and with
        what was named.
    where : tuple of Disagreement
        By posture, point, axis and band; 1 is what scatter and allowance explain.
    interface : str
        Where along the chain the model departs, in words.
    gates : tuple of Gate
        What the checks without a model said.
    notes : tuple of str
        What a person must know beside.
    misfit_per_line : float
        chi² per real residual of the last model; about 0.5 where all is in it.
    next_test : NextTest or None
        The test that would tell most about what is still open.
    false_name_probability : float or None
        Of all names together; None: nothing is named.
    confidence : float or None
        In all names together, 0 to 1; None: nothing is named.
    calibration : Calibrated or None
        Limits of evidence, from replicas of the session; None: none were made.
    misfit : Misfit or None
        `misfit_per_line` beside what replicas leave; None: none were made.
    """

    verdict: Verdict
    summary: str
    effects: tuple[EffectFound, ...]
    rivals: tuple[RivalRow, ...]
    hidden: tuple[Hidden, ...]
    joint_stiffness_ranges: tuple[StiffnessRange, ...]
    gap_before: tuple[PostureGap, ...]
    gap_after: tuple[PostureGap, ...]
    where: tuple[Disagreement, ...]
    interface: str
    gates: tuple[Gate, ...]
    notes: tuple[str, ...]
    misfit_per_line: float
    next_test: NextTest | None = None
    false_name_probability: float | None = None
    confidence: float | None = None
    calibration: Calibrated | None = None
    misfit: Misfit | None = None
