"""Measurements as a file of another program gives them: FRFs and single hits, in SI.

What a file does not tell (a point, a direction, a unit) is None here, never filled in.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.uff_records import UffNodes, UffTraceLine
from armodal.protocols.foreign.variables import Listed, listing
from armodal.protocols.frf_records import FrfForm

__all__ = [
    "AXES",
    "Content",
    "Cut",
    "ForeignFrf",
    "ForeignHit",
    "Hints",
    "NotToldError",
    "ToldDof",
    "axis_direction",
    "check_frf_values",
    "check_signals",
    "clipped_coherence",
    "exact_rate",
    "not_measured",
    "parse_dof",
]

AXES = ("x", "y", "z")

_DOF = re.compile(r"([^:]{1,16})(?::([+-]?)([xyz]))?", re.IGNORECASE)
_MOST_DENOMINATOR = 1000
_COHERENCE_ROUNDING = 1e-6
_LARGEST_SIGNAL = 1e12  # N, m/s^2
_LARGEST_FRF = 1e30  # SI: its square is a number too
_SMALLEST_FRF = 1.0 / _LARGEST_FRF  # the largest line of a response: its square is not 0
_LARGEST_COHERENCE = 1.5  # above, it is something else: quantised ones of analysers reach 1.25


class NotToldError(ForeignFileError):
    """A file leaves open what only a person can say.

    `key` is the manifest's key for it, `listed` what is in the file.
    """

    def __init__(self, why: str, *, key: str, listed: tuple[Listed, ...] | None = None) -> None:
        super().__init__(why if listed is None else f"{why}; {listing(listed)}")
        self.why = why
        self.key = key
        self.listed = listed or ()


@dataclass(frozen=True, slots=True)
class ToldDof:
    """A point by the file's name for it, and its direction in the file's axes."""

    node: str | None
    direction: npt.NDArray[np.float64] | None  # (3,) unit

    @property
    def label(self) -> str:
        """Axis letter for a direction along an axis, else empty."""
        if self.direction is None:
            return ""
        at = int(np.argmax(np.abs(self.direction)))
        return AXES[at] if abs(abs(self.direction[at]) - 1.0) < 1e-6 else ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForeignFrf:
    """One FRF in SI; the line at 0 Hz is left out."""

    origin: str
    form: FrfForm
    response: ToldDof
    reference: ToldDof
    freq_hz: npt.NDArray[np.float64]  # (n,)
    values: npt.NDArray[np.complex128]  # (n,)
    coherence: npt.NDArray[np.float64] | None  # (n,) as told: a little above 1 is left so
    variance: npt.NDArray[np.float64] | None = None  # (n,) of the values, where the file tells it
    averages: int | None = None  # of this FRF, where the file tells it for each


@dataclass(frozen=True, slots=True, kw_only=True)
class ForeignHit:
    """One hit: force and simultaneous accelerations in SI."""

    origin: str
    rate_hz: Fraction
    force_n: npt.NDArray[np.float64]  # (n,)
    acceleration_m_s2: npt.NDArray[np.float64]  # (k, n)
    hit: ToldDof
    responses: tuple[ToldDof, ...]  # k


@dataclass(frozen=True, slots=True, kw_only=True)
class Content:
    """Everything one file gives.

    `said` are sentences about what it left open or what was put right, `read_as` those about how
    it was understood.
    """

    origin: str
    frfs: tuple[ForeignFrf, ...] = ()
    hits: tuple[ForeignHit, ...] = ()
    nodes: UffNodes | None = None  # positions in m
    trace_lines: tuple[UffTraceLine, ...] = ()
    averages: int | None = None
    decay_rad_s: float | None = None
    said: tuple[str, ...] = ()
    read_as: tuple[str, ...] = ()
    found: tuple[Listed, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """What the manifest says of records with many hits; None leaves it to the pulses.

    wanted : whether records are cut at all.
    record_s, pretrigger_s : length of a hit's record, and what of it lies before the pulse.
    level_n : force from which a pulse is a hit.
    apart_s : pulses closer than this are one hit.
    """

    wanted: bool = True
    record_s: float | None = None
    pretrigger_s: float | None = None
    level_n: float | None = None
    apart_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Hints:
    """What the manifest says about a file; None where it says nothing."""

    form: FrfForm | None = None
    response_unit: str | None = None
    force_unit: str | None = None
    responses: tuple[ToldDof, ...] = ()
    references: tuple[ToldDof, ...] = ()
    first_line_hz: float | None = None
    line_spacing_hz: float | None = None
    kind: str | None = None  # "frf" or "hit"
    variables: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # names by role
    rate_hz: float | None = None
    force_scale: float | None = None  # N per unit of the file's numbers
    response_scale: float | None = None  # SI per unit of the file's numbers
    cut: Cut = Cut()
    force_file: Path | None = None  # where the force is not in the file of its responses

    @property
    def reference(self) -> ToldDof | None:
        """Return the reference of a file with one."""
        return self.references[0] if self.references else None


def axis_direction(code: int) -> npt.NDArray[np.float64] | None:
    """Return the unit vector of a direction code +-1, +-2, +-3; None for any other.

    >>> axis_direction(-2).tolist()
    [0.0, -1.0, 0.0]
    """
    if not 1 <= abs(code) <= 3:
        return None
    direction = np.zeros(3)
    direction[abs(code) - 1] = np.sign(code)
    return direction


def parse_dof(text: str, origin: str) -> ToldDof:
    """Read a degree of freedom such as `3:x`, `101:-z` or `3`.

    Raises
    ------
    ForeignFileError
        If it is none.
    """
    match = _DOF.fullmatch(text.strip())
    if match is None:
        raise ForeignFileError(
            f"{origin}: wanted a point and a direction such as '3:x' or '101:-z', got {text!r}"
        )
    direction = None
    if match[3]:
        code = AXES.index(match[3].lower()) + 1
        direction = axis_direction(-code if match[2] == "-" else code)
    return ToldDof(match[1], direction)


def exact_rate(
    times_s: npt.NDArray[np.float64], origin: str, *, rounding: float = 1e-7
) -> Fraction:
    """Return the sampling rate of an even time axis: the simplest within its rounding.

    Parameters
    ----------
    times_s
        (n,) times of the samples.
    origin
        How messages name the file.
    rounding
        Relative; a step written with six digits, as universal files have it, is off by up to
        5e-6, so that 4096 Hz would come back as 4095.994.

    Raises
    ------
    ForeignFileError
        If there are fewer than 64 samples, times are not finite, or do not rise evenly.
    """
    if len(times_s) < 64:
        raise ForeignFileError(f"{origin}: wanted 64 samples or more, got {len(times_s)}")
    steps = np.diff(times_s)
    if not (np.isfinite(times_s).all() and (steps > 0).all()):
        raise ForeignFileError(f"{origin}: wanted times that rise, got others; export it again")
    mean = float(times_s[-1] - times_s[0]) / (len(times_s) - 1)
    spread = float(np.max(np.abs(times_s - times_s[0] - mean * np.arange(len(times_s)))))
    # Times printed with few digits jump, but they do not drift.
    if spread > 0.5 * mean or not mean > 0.0:
        raise ForeignFileError(
            f"{origin}: wanted evenly sampled times, they stray by {spread / mean:.2g} samples; "
            "resample the record"
        )
    rate = 1.0 / mean
    for denominator in range(1, _MOST_DENOMINATOR + 1):
        simple = Fraction(round(rate * denominator), denominator)
        if abs(float(simple) / rate - 1.0) <= rounding:
            return simple
    return Fraction(round(rate * 1e6), 10**6)


def check_frf_values(
    freq_hz: npt.NDArray[np.float64], values: npt.NDArray[np.complex128], origin: str
) -> npt.NDArray[np.bool_]:
    """Return which lines to keep (all above 0 Hz), or refuse FRFs no fit could use.

    Raises
    ------
    ForeignFileError
        For frequencies that do not increase, NaN, fewer than two lines, nothing but one value, or
        nothing above 1e-30.
    """
    if freq_hz.shape != values.shape or freq_hz.ndim != 1:
        raise ForeignFileError(
            f"{origin}: wanted one value a line, got {values.shape} for {freq_hz.shape}"
        )
    if not np.isfinite(freq_hz).all() or (np.diff(freq_hz) <= 0).any() or (freq_hz < 0).any():
        raise ForeignFileError(
            f"{origin}: wanted frequencies from 0 Hz that increase, got others; export it again"
        )
    keep = freq_hz > 0.0
    if np.count_nonzero(keep) < 2:
        raise ForeignFileError(
            f"{origin}: wanted two lines or more above 0 Hz, got {np.count_nonzero(keep)}; "
            "export the whole band"
        )
    with np.errstate(over="ignore", invalid="ignore"):
        bad = int(np.count_nonzero(~(np.abs(values[keep]) < _LARGEST_FRF)))
    if bad:
        raise ForeignFileError(
            f"{origin}: wanted numbers below {_LARGEST_FRF:g}, got NaN, infinity or more on "
            f"{bad} of {np.count_nonzero(keep)} lines; leave this FRF out or measure it again"
        )
    if not np.any(values[keep]) or np.all(values[keep] == values[keep][0]):
        raise ForeignFileError(
            f"{origin}: wanted a response, got the constant {values[keep][0]:.3g} on every line; "
            "check the channel, or leave this FRF out"
        )
    largest = float(np.max(np.abs(values[keep])))
    if largest < _SMALLEST_FRF:
        raise ForeignFileError(
            f"{origin}: wanted a response, got numbers up to {largest:.3g} only; check the "
            "channel and its unit, or leave this FRF out"
        )
    result: npt.NDArray[np.bool_] = keep
    return result


def not_measured(values: npt.NDArray[np.complex128]) -> bool:
    """Whether one FRF of a matrix (n,) is what programs fill a hole with: 0 or NaN throughout."""
    return bool(np.all(values == 0.0) or np.all(np.isnan(values)))


def check_signals(signals: npt.NDArray[np.float64], origin: str) -> None:
    """Refuse samples that are not finite, or larger than any sensor's.

    Raises
    ------
    ForeignFileError
        For NaN, infinity, or forces and accelerations of 1e12 SI and more.
    """
    if not np.isfinite(signals).all() or np.max(np.abs(signals), initial=0.0) > _LARGEST_SIGNAL:
        raise ForeignFileError(
            f"{origin}: wanted finite samples below {_LARGEST_SIGNAL:g}, got NaN, infinity or "
            "larger ones; leave the channel out, or export it again"
        )


def clipped_coherence(
    values: npt.NDArray[np.float64], origin: str, said: list[str]
) -> npt.NDArray[np.float64] | None:
    """Return a coherence, clipped at 0; None, and a word, for what is no coherence.

    Quantised spectra and unequal windows bring a little more than 1. That is said, and left for
    `analyzer` to clip: it shows how wrong the coherence may be on other lines.
    """
    told = values[np.isfinite(values)]
    low, high = (float(told.min()), float(told.max())) if told.size else (0.0, 0.0)
    if low < -_COHERENCE_ROUNDING or high > _LARGEST_COHERENCE or not told.size:
        said.append(f"{origin}: the coherence is from {low:.3g} to {high:.3g}: it is left out")
        return None
    if high > 1.0 + _COHERENCE_ROUNDING:
        said.append(f"{origin}: the coherence reaches {high:.3g}: clipped to 1")
    if told.size < values.size:
        said.append(f"{origin}: no coherence on {values.size - told.size} lines: taken as 0 there")
    return np.asarray(np.maximum(np.nan_to_num(values), 0.0))
