r"""Smart hit selection: of more hits than needed, keep those that agree.

Two kinds of hits are dropped, and told apart, because they mean different things for the stated
uncertainty:

unlike
    The hit differs from the others by more than their scatter explains. With the weighted
    distance :math:`d_{ij} = \sum w |h_i - h_j|^2` of single-hit FRFs, the statistic of hit i of
    m is

    .. math:: F_i = \frac{m-1}{m} \frac{|h_i - \bar h_{(i)}|^2}{s^2_{(i)}}

    with mean and scatter of the others. If the error of a hit is one complex number common to all
    lines and axes (the least degrees of freedom its noise may have: aim, level, mounting), F_i
    follows F(2, 2(m-2)), whose tail is :math:`(1 + F/(m-2))^{-(m-2)}`. Errors independent from line
    to line average out and make F_i closer to 1, so a hit is never dropped too readily. Up to half
    of the hits are tested by the generalised extreme Studentised deviate procedure, in which one
    outlier does not hide another.

surplus
    The hit is good, but more are there than are to be kept. Those farthest from the mean of all
    good hits go. The scatter that is left then looks smaller than a hit's scatter is: the result
    carries the factor that undoes it. Choosing also moves the mean; its variance is at most 5/4 of
    a hit's over the number kept (simulated, two degrees of freedom and more, 3 to 10 hits).

The tightest cluster of hits is not what is kept: which hits lie close together is chance, and the
mean of the closest varies by more than their own scatter says.

References
----------
Rosner, Technometrics 25 (1983) 165. Closest pairs: Lieblein, J. Res. Nat. Bur. Stand. 48 (1952)
255.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.noise import smooth_lines
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError

__all__ = ["DroppedHit", "HitSelection", "coherence_of_all", "select_hits"]

_Frfs = npt.NDArray[np.complex128]
_Real = npt.NDArray[np.float64]

_FEWEST_TESTED = 4
_SMOOTHED = 8  # lines on either side over which the scatter that weights a line is averaged
_GAIN_SHARE = 0.25  # of the distance left after a common factor: then the factor is the reason
_CHOICE = 1.25  # variance of the kept hits' mean over a hit's variance / number kept, at most
_DIGITS = 1e-12  # scatter below this of the FRF, squared, is rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class DroppedHit:
    """A hit left out, with its reason.

    `reason` is "unlike" or "surplus", `note` a sentence. `p_value` is the probability, at least,
    of so unlike a hit among good ones; nan for surplus hits.
    """

    hit: int
    reason: str
    distance: float
    p_value: float
    note: str


@dataclass(frozen=True, slots=True, kw_only=True)
class HitSelection:
    """Hits kept, in their order, and dropped.

    `distance` (n_hits,) is each hit's mean squared distance from the mean of the kept, in units of
    the typical scatter of a hit. `scatter_factor`, 1 or more, is a good hit's scatter over that
    seen among the kept; `variance_factor` multiplies the variance of an averaged FRF estimated from
    the kept hits alone. Both are 1 unless surplus hits were dropped. `note` says what could not
    be tested, or is empty.
    """

    kept: tuple[int, ...]
    dropped: tuple[DroppedHit, ...]
    distance: _Real
    scatter_factor: float
    variance_factor: float
    note: str


def select_hits(
    frfs: npt.ArrayLike,
    freq_hz: npt.ArrayLike,
    *,
    keep: int | None = None,
    false_drop: float = 0.01,
) -> HitSelection:
    """Choose among the hits of one point in one posture.

    Parameters
    ----------
    frfs
        (n_hits, n_axes, n_freq), the FRF of every single hit, any form and unit.
    freq_hz
        (n_freq,).
    keep
        Hits to keep at most; None keeps every hit that is not unlike the others.
    false_drop
        Probability of dropping any hit of a good set as unlike.

    Returns
    -------
    HitSelection
        With fewer than four hits none is dropped as unlike: two that agree against one are no
        proof.

    Raises
    ------
    EstimateError
        If the array is not three-dimensional, not finite, empty, or `keep` or `false_drop` is out
        of range.
    """
    H, freq = _checked(frfs, freq_hz, keep, false_drop)
    n = len(H)
    weight = _weights(H)
    distance = _pair_distances(H, weight)
    unlike = _unlike(distance, false_drop)
    good = [i for i in range(n) if i not in unlike]
    kept = good
    if keep is not None and len(good) > keep:
        from_mean = _distances_from_mean(distance, good)
        kept = sorted(sorted(good, key=lambda i: float(from_mean[i]))[:keep])
    away = _distances_from_mean(distance, kept)
    typical = _scatter(distance, good)
    away = away / typical if typical > 0.0 else away
    notes = {i: _difference(H[i], H[kept].mean(axis=0), weight, freq) for i in unlike}
    surplus = [i for i in good if i not in kept]
    factor = _scatter_factor(distance, good, kept)
    dropped = [
        DroppedHit(hit=i, reason="unlike", distance=float(away[i]), p_value=p_value, note=notes[i])
        for i, p_value in unlike.items()
    ] + [
        DroppedHit(
            hit=i,
            reason="surplus",
            distance=float(away[i]),
            p_value=float("nan"),
            note=f"a good hit, farther from the mean than the {len(kept)} kept",
        )
        for i in surplus
    ]
    return HitSelection(
        kept=tuple(kept),
        dropped=tuple(sorted(dropped, key=lambda hit: hit.hit)),
        distance=frozen_array(away, np.float64),
        scatter_factor=factor,
        variance_factor=factor * (_CHOICE if surplus else 1.0),
        note=""
        if n >= _FEWEST_TESTED
        else f"cannot tell: {n} hits are too few to call one unlike the others, four are wanted",
    )


def coherence_of_all(coherence: _Real, scatter_factor: float) -> _Real:
    """Coherence that hits would have shown had none been dropped as surplus.

    Noise over signal, (1 - g)/g, is in proportion to the scatter.

    >>> float(coherence_of_all(np.array(0.98), 1.0))
    0.98
    """
    g = np.asarray(coherence, dtype=np.float64)
    whole: _Real = g / (g + scatter_factor * (1.0 - g))
    return whole


def _checked(
    frfs: npt.ArrayLike, freq_hz: npt.ArrayLike, keep: int | None, false_drop: float
) -> tuple[_Frfs, _Real]:
    H = np.asarray(frfs, dtype=np.complex128)
    freq = np.asarray(freq_hz, dtype=np.float64)
    if H.ndim != 3 or not H.size or freq.shape != H.shape[2:]:
        raise EstimateError(
            f"hit selection needs FRFs (n_hits, n_axes, n_freq) and as many frequencies, got "
            f"{H.shape} and {freq.shape}; give the FRFs of one point, hit by hit"
        )
    if not np.all(np.isfinite(H)):
        hits = np.flatnonzero(~np.isfinite(H).all(axis=(1, 2)))
        raise EstimateError(
            f"hit selection needs finite FRFs, those of hits {', '.join(map(str, hits))} are not; "
            "leave out the lines without force"
        )
    if keep is not None and keep < 1:
        raise EstimateError(f"hits to keep must be 1 or more, got {keep}")
    if not 0.0 < false_drop < 1.0:
        raise EstimateError(f"false_drop is a probability between 0 and 1, got {false_drop:g}")
    return H, freq


def _weights(H: _Frfs) -> _Real:
    """One over the typical squared difference of two hits: (n_axes, n_freq), mean one.

    The median over pairs keeps a few unlike hits from hiding in a large scatter of their own.
    """
    first, second = np.triu_indices(len(H), 1)
    if not len(first):
        return np.ones(H.shape[1:])
    squared = np.abs(H[first] - H[second]) ** 2
    half_width = min(_SMOOTHED, H.shape[2] // 4)
    typical = smooth_lines(np.median(squared, axis=0), half_width)
    power = smooth_lines(np.mean(np.abs(H) ** 2, axis=0), half_width)
    floor = np.maximum(_DIGITS * power, np.finfo(float).tiny)
    weight: _Real = 1.0 / np.maximum(typical, floor)
    weight /= H[0].size
    return weight


def _pair_distances(H: _Frfs, weight: _Real) -> _Real:
    """Weighted squared distances of all pairs: (n_hits, n_hits)."""
    return np.array([[np.sum(weight * np.abs(a - b) ** 2) for b in H] for a in H])


def _scatter(distance: _Real, hits: list[int]) -> float:
    """Unbiased variance of a hit, from the distances of all pairs among `hits`."""
    m = len(hits)
    return float(distance[np.ix_(hits, hits)].sum() / (2.0 * m * (m - 1))) if m > 1 else 0.0


def _distances_from_mean(distance: _Real, hits: list[int]) -> _Real:
    """Squared distance of every hit from the mean of `hits`: (n_hits,)."""
    among = distance[np.ix_(hits, hits)].mean() / 2.0
    squared: _Real = distance[:, hits].mean(axis=1) - among
    return np.maximum(squared, 0.0)


def _unlike(distance: _Real, false_drop: float) -> dict[int, float]:
    """Hits proven unlike the others, with their p-values."""
    left = list(range(len(distance)))
    removed: list[tuple[int, float]] = []
    proven = 0
    for _ in range((len(distance) - 1) // 2):
        m = len(left)
        if m < _FEWEST_TESTED:
            break
        p_values = {i: _p_value(distance, i, [j for j in left if j != i]) for i in left}
        worst = min(left, key=lambda i: p_values[i])
        removed.append((worst, p_values[worst]))
        left.remove(worst)
        if m * p_values[worst] <= false_drop:
            proven = len(removed)
    return dict(removed[:proven])


def _p_value(distance: _Real, hit: int, others: list[int]) -> float:
    """Probability of a hit so far from the others, by the F tail of the module's head."""
    m = len(others) + 1
    away = float(_distances_from_mean(distance, others)[hit])
    scatter = _scatter(distance, others)
    if scatter <= 0.0:
        return 0.0 if away > 0.0 else 1.0
    ratio = away / (scatter * (1.0 + 1.0 / (m - 1)))
    return float((1.0 + ratio / (m - 2)) ** -(m - 2))


def _scatter_factor(distance: _Real, good: list[int], kept: list[int]) -> float:
    """Scatter of all good hits over that of the kept, at least 1."""
    if len(kept) == len(good) or len(kept) < 2:
        return 1.0
    kept_scatter = _scatter(distance, kept)
    return max(_scatter(distance, good) / kept_scatter, 1.0) if kept_scatter > 0.0 else 1.0


def _difference(h: _Frfs, mean: _Frfs, weight: _Real, freq: _Real) -> str:
    """Say in what a hit differs: a common factor, or somewhere in the spectrum."""
    total = float(np.sum(weight * np.abs(h - mean) ** 2))
    # Lines count by their size here, not by their scatter: a factor shows at the peaks.
    gain = complex(np.vdot(mean, h) / np.vdot(mean, mean))
    left = float(np.sum(weight * np.abs(h - gain * mean) ** 2))
    if left < _GAIN_SHARE * total:
        turned = np.degrees(np.angle(gain))
        phase = f" and turned by {turned:.0f} deg" if abs(turned) >= 5.0 else ""
        return (
            f"all its FRFs are {abs(gain):.3g} times those of the others{phase}: struck askew or "
            "at another point, or a cable moved"
        )
    axis, line = np.unravel_index(int(np.argmax(weight * np.abs(h - mean) ** 2)), h.shape)
    return (
        f"its FRFs differ from those of the others in shape, most at {freq[line]:.4g} Hz on axis "
        f"{axis + 1}: another point or direction struck, a second contact, or a disturbance"
    )
