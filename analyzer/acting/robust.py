"""Shapers for modes that are only known within intervals, over a set of postures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.acting.shapers import KINDS, Notch, Shaper, convolved, notch, shaper
from armodal.analyzer.confidence import TWO_SIDED_95
from armodal.analyzer.corrected.prediction import ArmPrediction
from armodal.protocols.errors import EstimateError

__all__ = ["Candidate", "ModeBox", "candidates", "mode_boxes", "recommended"]

Array = npt.NDArray[np.float64]

_GRID = 41  # frequencies of an interval at which the residual is looked at
_MOST_DAMPING = 0.9  # a mode with more does not swing
_NOTCH_LEFT = 0.05  # |N| wanted at an interval's end, about half its width over the pole's damping
_NARROWEST, _WIDEST = 0.1, 0.9  # damping of a notch's pole: beyond, it rings or comes as late as ZV


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeBox:
    """What a mode may be: 95 % intervals, united over postures."""

    f_hz: tuple[float, float]
    damping_ratio: tuple[float, float]

    def grid(self) -> tuple[Array, Array]:
        """Return frequencies and damping ratios that cover it."""
        f, z = np.meshgrid(np.linspace(*self.f_hz, _GRID), np.linspace(*self.damping_ratio, 3))
        return f.ravel(), z.ravel()


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A shaper or a chain of notches, and what it promises."""

    kind: str
    shaper: Shaper | None
    notches: tuple[Notch, ...]
    residual: float  # the largest over all boxes, of the unshaped
    residual_by_mode: tuple[float, ...]
    duration_s: float  # by which a command becomes longer; of a notch none: it dies away
    delay_s: float


def mode_boxes(predictions: Sequence[ArmPrediction], n_modes: int) -> tuple[ModeBox, ...]:
    """Unite the intervals of the n lowest modes over postures.

    Raises
    ------
    EstimateError
        If a posture has fewer modes that swing.
    """
    fewest = min(len(p.modes.f_hz) for p in predictions)
    if fewest < n_modes:
        raise EstimateError(
            f"wanted {n_modes} modes in every posture, got {fewest}; ask for fewer with --modes"
        )
    boxes = []
    for i in range(n_modes):
        rows = [
            (
                p.modes.f_hz[i],
                TWO_SIDED_95 * p.f_std_hz[i],
                p.modes.damping_ratio[i],
                TWO_SIDED_95 * p.damping_std[i],
            )
            for p in predictions
        ]
        f, df, z, dz = np.array(rows).T
        low = float(np.min(f - df))
        if low <= 0.0:
            raise EstimateError(
                f"mode {i + 1} is known to no better than {np.max(df):.1f} Hz: nothing can be "
                "shaped for it; measure the arm, and write an arm file with `armodal gap`"
            )
        boxes.append(
            ModeBox(
                f_hz=(low, float(np.max(f + df))),
                damping_ratio=(
                    float(max(np.min(z - dz), 0.0)),
                    float(min(np.max(z + dz), _MOST_DAMPING)),
                ),
            )
        )
    return tuple(boxes)


def candidates(boxes: Sequence[ModeBox]) -> tuple[Candidate, ...]:
    """Return one of every kind, each set so that its largest residual is least."""
    found = [_of_kind(kind, boxes) for kind in KINDS]
    return (*found, _notches(boxes))


def recommended(every: Sequence[Candidate], limit: float) -> Candidate:
    """Return the quickest whose residual is below a limit; else the one with the least."""
    good = [own for own in every if own.residual <= limit]
    if good:
        return min(good, key=lambda own: own.delay_s)
    return min(every, key=lambda own: own.residual)


def _of_kind(kind: str, boxes: Sequence[ModeBox]) -> Candidate:
    parts = []
    for box in boxes:
        f, z = box.grid()
        middle = float(np.mean(box.damping_ratio))

        def worst(at: float, f: Array = f, z: Array = z, middle: float = middle) -> float:
            return float(shaper(kind, at, middle).residual(f, z).max())

        low, high = box.f_hz
        room = max(high - low, 1e-6 * high)
        best = scipy.optimize.minimize_scalar(
            worst, bounds=(low - 0.1 * room, high + 0.1 * room), method="bounded"
        )
        parts.append(shaper(kind, float(best.x), middle))
    whole = convolved(parts)
    left = [float(whole.residual(*box.grid()).max()) for box in boxes]
    return Candidate(
        kind=kind,
        shaper=whole,
        notches=(),
        residual=max(left),
        residual_by_mode=tuple(left),
        duration_s=whole.duration_s,
        delay_s=whole.delay_s,
    )


def _notches(boxes: Sequence[ModeBox]) -> Candidate:
    """A notch for each mode, as wide as its interval needs."""
    own = []
    for box in boxes:
        middle = float(np.sqrt(box.f_hz[0] * box.f_hz[1]))
        half = (box.f_hz[1] - box.f_hz[0]) / (2.0 * middle)
        damping = float(np.mean(box.damping_ratio))
        pole = np.clip(half / _NOTCH_LEFT, 2.0 * damping + _NARROWEST, _WIDEST)
        own.append(notch(middle, damping, float(pole)))
    left = []
    for box in boxes:
        f, z = box.grid()
        left.append(float(np.prod([n.residual(f, z) for n in own], axis=0).max()))
    return Candidate(
        kind="notch",
        shaper=None,
        notches=tuple(own),
        residual=max(left),
        residual_by_mode=tuple(left),
        duration_s=0.0,
        delay_s=float(sum(n.delay_s for n in own)),
    )
