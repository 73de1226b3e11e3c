r"""FRFs of several hammers as one: each line by what it is worth.

A soft tip excites low frequencies well, a hard one high ones. With estimates H_i of random error
v_i = E|error|^2, the combination of least variance is

    H = sum w_i H_i / sum w_i,    w_i = 1 / v_i,    E|error of H|^2 = 1 / sum w_i,

never more than the least v_i. v_i is what coherence says, |H|^2 (1 - g^2) / (g^2 (n - 1)), which
is the scatter of the hits, smoothed over lines. Since it is estimated itself, with f_i degrees of
freedom, the result's variance is larger by 1 + 4 sum p_i (1 - p_i) / f_i, p_i = w_i / sum w_i.

Estimates that differ by more than their scatter are not the same FRF: the hammers' sensitivities
differ, the structure answers a harder blow otherwise, or it has changed. Then every v_i gets the
variance between them in addition, so that the merged deviation covers all of them, and it is said.
Asked are two things: whether one estimate is another times a number, which all lines share, and
whether they differ beyond that over a few lines.

References
----------
Random error of an FRF: Bendat and Piersol, Random Data, 4th ed. (2010), Eq. (9.73). Estimated
weights: Meier, Biometrics 9 (1953) 59. Variance between: DerSimonian and Laird, Control. Clin.
Trials 7 (1986) 177.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.merge_lines import MergeInput, common_lines
from armodal.analyzer.modal.noise import independent_line_share, scatter_dof, smooth_lines
from armodal.protocols.arrays import frozen_array
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["Disagreement", "MergedFrf", "merge_frfs"]

_Real = npt.NDArray[np.float64]
_Complex = npt.NDArray[np.complex128]
_Flags = npt.NDArray[np.bool_]

_CHANCE = 1e-3  # that hammers which agree are said to differ, by their stated scatter
_HALF_WIDTH = 8  # lines to either side over which estimates are compared
_FEWEST = 2  # hits taken where their number is not told: the least that tell a scatter


@dataclass(frozen=True, slots=True, kw_only=True)
class Disagreement:
    """How FRFs differ beyond their scatter.

    `gain` is the second estimate over the first where all lines share the factor, else 1; `lines`
    the share of lines whose variance was widened; the band holds them.
    """

    response: int
    reference: int
    gain: complex
    lines: float
    low_hz: float
    high_hz: float
    largest: float  # difference over |H|, rms, where it is largest


@dataclass(frozen=True, slots=True, kw_only=True)
class MergedFrf:
    """Merged FRFs, and how every input counts: (n_inputs, n_resp, n_ref, n_freq), sum 1."""

    frf: FrequencyResponse
    weight: _Real
    disagreements: tuple[Disagreement, ...]


def merge_frfs(frfs: Sequence[FrequencyResponse]) -> MergedFrf:
    """Merge FRFs of one posture, line by line by their variance.

    Parameters
    ----------
    frfs
        Two or more, of one form, on lines of one spacing and window; each where its hammer excites.
        Responses and references are those of the first; of the others' those it has too.

    Returns
    -------
    MergedFrf
        On the lines of all; where FRFs agree, with a variance never above the least of any.

    Raises
    ------
    EstimateError
        If they are not estimates of the same FRFs, or one tells no variance.
    """
    given = common_lines(frfs)
    n_hits = np.where(given.n_hits == 0, _FEWEST, given.n_hits)
    between, found = _between(given, np.maximum(2.0 * (n_hits - 1), 1.0))
    v = given.variance + between
    w = np.where(given.there, 1.0 / v, 0.0)
    total = w.sum(axis=0)
    p = w / total
    value = np.sum(p * given.values, axis=0)
    dof = scatter_dof(n_hits, independent_line_share(given.decay_rad_s, given.spacing_hz))
    estimated = 1.0 + 4.0 * np.sum(p * (1.0 - p) / dof[..., None], axis=0)
    least = np.min(np.where(given.there, v, np.inf), axis=0)
    variance = np.minimum(estimated / total, least)
    taken = np.asarray(given.there.any(axis=-1))
    all_hits = np.where(taken, given.n_hits, 0).sum(axis=0)
    told = np.asarray(((given.n_hits > 0) | ~taken).all(axis=0))
    power = np.abs(value) ** 2
    several = np.maximum(all_hits - 1, 1)[:, :, None]
    coherence = power / np.maximum(power + several * variance, np.finfo(float).tiny)
    frf = replace(
        frfs[0],
        freq_hz=frozen_array(given.freq_hz, np.float64),
        values=frozen_array(value, np.complex128),
        variance=frozen_array(variance, np.float64),
        coherence=frozen_array(np.where(told[:, :, None], coherence, np.nan), np.float64),
        n_hits=frozen_array(np.where(told, all_hits, 0), np.int64),
    )
    return MergedFrf(frf=frf, weight=frozen_array(p, np.float64), disagreements=found)


def _between(given: MergeInput, hits_dof: _Real) -> tuple[_Real, tuple[Disagreement, ...]]:
    """Variance between estimates, (n_resp, n_ref, n_freq), 0 where scatter explains all."""
    n_inputs, n_resp, n_ref, n_freq = given.values.shape
    between: _Real = np.zeros((n_resp, n_ref, n_freq))
    found: list[Disagreement] = []
    for i, j in np.ndindex(n_resp, n_ref):
        for second in range(1, n_inputs):
            first = _best_partner(given, second, i, j)
            if first is None:
                continue
            pair = [first, second]
            both = given.there[first, i, j] & given.there[second, i, j]
            told = _compare(
                given.values[pair, i, j][:, both],
                given.variance[pair, i, j][:, both],
                hits_dof[pair, i, j],
                _CHANCE / (n_resp * n_ref),
            )
            if not told.differ.any():
                continue
            between[i, j, both] = np.maximum(between[i, j, both], told.between)
            # A factor holds on the lines of one alone too.
            level = np.max(np.abs(given.values[:, i, j]) ** 2, axis=0)
            factor = 0.5 * abs(told.gain - 1.0) ** 2 * level
            between[i, j] = np.maximum(between[i, j], factor)
            at = given.freq_hz[both][told.differ]
            found.append(
                Disagreement(
                    response=i,
                    reference=j,
                    gain=told.gain,
                    lines=float(np.mean(told.differ)),
                    low_hz=float(at[0]),
                    high_hz=float(at[-1]),
                    largest=told.largest,
                )
            )
    return between, tuple(found)


def _best_partner(given: MergeInput, second: int, i: int, j: int) -> int | None:
    """The earlier estimate that shares most lines with one; None without any line."""
    shared = [
        int(np.count_nonzero(given.there[k, i, j] & given.there[second, i, j]))
        for k in range(second)
    ]
    best = int(np.argmax(shared))
    return best if shared[best] > 2 * _HALF_WIDTH else None


@dataclass(frozen=True, slots=True)
class _Compared:
    """Two estimates of one FRF on the lines they share."""

    differ: _Flags
    between: _Real
    gain: complex
    largest: float


def _compare(values: _Complex, variance: _Real, hits_dof: _Real, chance: float) -> _Compared:
    """Ask whether two estimates (2, n) differ by a factor, and over a few lines beyond it.

    What a hit does otherwise (aim, level) it does on many lines: hits are counted, not lines, as
    if the scatter of neighbouring lines were one number, and for the factor that of all.
    """
    expected = variance.sum(axis=0)
    power = np.mean(np.abs(values) ** 2, axis=0)
    share = power / expected
    share /= share.sum()
    first_power = np.sum(np.abs(values[0]) ** 2 / expected)
    gain = complex(np.sum(values[0].conj() * values[1] / expected) / first_power)
    common = float(share @ np.sqrt(expected / power)) ** 2
    dof = _satterthwaite(variance @ share, hits_dof)
    by_factor = abs(gain - 1.0) ** 2 > common * _exceeded_with(chance, dof)
    apart = np.abs(values[1] - gain * values[0]) ** 2
    size = variance[1] + abs(gain) ** 2 * variance[0]
    near, of_scatter = smooth_lines(np.stack([apart, size]), _HALF_WIDTH)
    tests = max(apart.size / (1.0 + 2.0 * _HALF_WIDTH), 1.0)
    differ = near > of_scatter * _exceeded_with(chance / tests, dof)
    differ |= by_factor
    whole = smooth_lines(np.abs(values[1] - values[0]) ** 2, _HALF_WIDTH)
    excess = whole - smooth_lines(expected, _HALF_WIDTH)
    between = np.where(differ, np.maximum(excess, 0.0) / 2.0, 0.0)
    relative = whole / smooth_lines(power, _HALF_WIDTH)
    largest = float(np.sqrt(np.max(np.where(differ, relative, 0.0))))
    return _Compared(differ, between, gain if by_factor else 1.0 + 0.0j, largest)


def _exceeded_with(chance: float, dof: float) -> float:
    """What F of 2 and `dof` degrees of freedom exceeds with a chance: (1 + 2 F / dof)^(-dof / 2).

    Johnson, Kotz, Balakrishnan, Continuous Univariate Distributions 2 (1995), chapter 27.
    """
    return 0.5 * dof * math.expm1(-2.0 / dof * math.log(chance))


def _satterthwaite(variance: _Real, dof: _Real) -> float:
    """Degrees of freedom of a sum of estimated variances (2,)."""
    return float(variance.sum() ** 2 / np.sum(variance**2 / dof))
