"""Homogeneity: a harder hit has to give the same FRF.

Every single hit's FRF differs from the mean of its point by a gain g and by a complex shift b of
the frequency scale, to first order

    H_h(s) - H(s) = g H(s) - b s dH/ds,

whose real part moves all frequencies by b and whose imaginary part all damping ratios by -Im b. The
three are regressed on the logarithm of the level with an intercept a point, so that what differs
between points does not enter, and judged by Student's t.

References
----------
Ewins, Modal Testing, 2nd ed. (2000), section 3.10 (homogeneity); regression within groups: any
text on analysis of covariance.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.checks.modal_basis import modal_basis, real_lines
from armodal.analyzer.checks.records import Fault, Finding, Outcome

__all__ = ["homogeneity"]

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

LEVELS = 3
_APART = 1.2  # ratio of two levels that count as two
_P_FAULT = 1e-4
_MOST_SCATTER = 0.3  # of the response: more is a point that hardly moves
_NAMES = ("gain", "frequency", "damping ratio")
_MATERIAL = np.array([0.03, 0.003, 0.003])  # a doubling of the force: relative, relative, absolute


def homogeneity(
    posture: str,
    s: ComplexArray,
    poles: Sequence[complex],
    hits: Sequence[ComplexArray],
    level: Sequence[Array],
) -> Finding:
    """Check one posture.

    Parameters
    ----------
    s
        (n_lines,) Laplace lines.
    poles
        Poles of the modes in rad/s: the slope dH/ds comes from a fit of residues to them.
    hits
        Per point (n_hits, n_axes, n_lines) accelerance of single hits.
    level
        Per point (n_hits,) a positive measure of the force, in any unit common to all.
    """
    usable = [
        i
        for i, own in enumerate(level)
        if _levels(own) >= LEVELS and _scatter(hits[i]) < _MOST_SCATTER
    ]
    say = _Say(posture)
    if not usable or not len(poles):
        why = (
            "no modes were fitted"
            if usable
            else f"no point that moves was hit at {LEVELS} levels or more, each 1.2 times the last"
        )
        return say(Outcome.CANNOT_TELL, None, 0.0, why)
    z: list[Array] = []
    effect: list[Array] = []
    for i in usable:
        doubled = np.log2(level[i])
        z.append(doubled - doubled.mean())
        found = _effects(s, poles, hits[i], level[i])
        effect.append(found - found.mean(axis=0))
    Z, E = np.concatenate(z), np.concatenate(effect)
    freedom = len(Z) - len(usable) - 1
    slope = Z @ E / (Z @ Z)
    rest = ((E - np.outer(Z, slope)) ** 2).sum(axis=0) / max(freedom, 1)
    std = np.sqrt(rest / (Z @ Z))
    p = 2.0 * scipy.special.stdtr(max(freedom, 1), -np.abs(slope) / np.maximum(std, 1e-300))
    half = scipy.special.stdtrit(max(freedom, 1), 0.995) * std
    words = ", ".join(
        f"{name} {100 * a:+.2f} ± {100 * b:.2f} %"
        for name, a, b in zip(_NAMES, slope, std, strict=True)
    )
    text = f"per doubling of the force: {words}"
    wrong = (p < _P_FAULT) & (np.abs(slope) > _MATERIAL)
    if wrong.any():
        return say(Outcome.FAULT, Fault.LEVEL_DEPENDENT, float(1.0 - p[wrong].min()), text)
    if np.any(np.abs(slope) + half > 3.0 * _MATERIAL):
        return say(Outcome.CANNOT_TELL, None, 0.0, f"too uncertain to tell; {text}")
    return say(Outcome.GOOD, None, 0.99, text)


class _Say:
    """Findings of one posture."""

    def __init__(self, posture: str) -> None:
        self._posture = posture

    def __call__(
        self, outcome: Outcome, fault: Fault | None, confidence: float, text: str
    ) -> Finding:
        return Finding(
            check="homogeneity",
            posture=self._posture,
            outcome=outcome,
            fault=fault,
            points=(),
            everywhere=fault is not None,
            confidence=confidence,
            text=text,
        )


def _scatter(frfs: ComplexArray) -> float:
    """Root mean square difference of single hits from their mean, relative to it."""
    mean = frfs.mean(axis=0)
    rest = np.mean(np.abs(frfs - mean) ** 2) / max(np.mean(np.abs(mean) ** 2), 1e-300)
    return float(np.sqrt(rest))


def _levels(level: Array) -> int:
    """Levels that are a factor apart."""
    count, last = 0, 0.0
    for value in np.sort(level):
        if value >= _APART * last:
            count, last = count + 1, float(value)
    return count


def _effects(s: ComplexArray, poles: Sequence[complex], frfs: ComplexArray, level: Array) -> Array:
    """Gain, frequency and damping change (n_hits, 3) of single hits from their mean.

    Noise of an FRF falls with the force. A mean that counted soft hits as much would hold their
    noise, and what is projected on it would have it too: soft hits would all seem to gain.
    """
    weight = level**2 / np.sum(level**2)
    mean = np.einsum("h,hal->al", weight, frfs)
    relative = 1.0 / np.sqrt(np.mean(np.abs(mean) ** 2, axis=0))
    step = 1e-4 * s  # the basis is analytic: central differences err by its square
    up, down = modal_basis(s + step, poles), modal_basis(s - step, poles)
    scale = (np.abs(s).max() / np.abs(s + step).max(), np.abs(s).max() / np.abs(s - step).max())
    # The last two signals are scaled by the largest line, which must not move with the step.
    up[-2:] /= np.array([[scale[0]], [scale[0] ** 2]])
    down[-2:] /= np.array([[scale[1]], [scale[1] ** 2]])
    basis = modal_basis(s, poles)
    coefficients = real_lines(mean * relative) @ np.linalg.pinv(real_lines(basis * relative))
    slope = coefficients @ ((up - down) / 2e-4)  # s dH/ds
    columns = np.stack(
        [
            real_lines(mean * relative).ravel(),
            real_lines(-slope * relative).ravel(),
            real_lines(1j * slope * relative).ravel(),
        ],
        axis=1,
    )
    data = real_lines((frfs - mean) * relative).reshape(len(frfs), -1)
    result: Array = data @ np.linalg.pinv(columns).T
    return result
