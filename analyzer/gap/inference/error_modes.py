"""How a right model is off, learnt from the session: error modes of every posture.

What a model leaves in a posture is a matrix, channels by lines. Its singular vectors are patterns
that channels and lines share, as a resonance that no parameter can move does. Each is an error of
its own with a random amplitude; errors of several postures are independent. So neighbouring lines
and points are not counted as if each told by itself.

A fit takes part of every error on itself. What it leaves in one posture is made as large as the
error was, on average, by the leverage of that posture: half way between what is left and what the
other postures foretell,

    e = (I - J P J')^-1/2 r ,       P = (J'J + I)^-1 over all postures .

References
----------
Bell and McCaffrey, Survey Methodology 28 (2002) 169: the bias-reduced linearization.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.analyzer.gap.inference.fit import Stage
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.space import Space

__all__ = [
    "Sensitivities",
    "curvature_of",
    "error_slopes",
    "opposed",
    "released",
    "sensitivities",
    "settled",
]

Array = npt.NDArray[np.float64]

_NOTHING = 1e-9  # of the whole: rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivities:
    """Of a posture (soft and hard hits of it together): derivatives and what is left, weighted.

    Lines count in the direction of real and imaginary parts.
    """

    raw: Array  # (n, M, 2L)
    clean: Array  # (n, M, 2L) mounting errors integrated out
    left: Array  # (M, 2L) likewise of the residual
    side: Array | None = None  # (M,) 1 for soft hits and -1 for hard ones, where they are apart


def sensitivities(
    stage: Stage, hypothesis: Hypothesis, space: Space, values: dict[str, float]
) -> list[Sensitivities]:
    """Return those of each posture of the session."""
    found: dict[str, list[tuple[int, Sensitivities]]] = {}
    for rows, together in stage.once(hypothesis, range(len(stage.lines))):
        y, dy = together.derivatives(hypothesis, space, values)
        for p, i in rows:
            J, clean, left = stage.weighings[p].sensitivities(y[i], dy[:, i])
            n, length = len(J), J.shape[-1]
            one = Sensitivities(
                raw=J.reshape(n, -1, length),
                clean=clean.reshape(n, -1, length),
                left=left.reshape(-1, length),
            )
            found.setdefault(stage.lines[p].name, []).append((p, one))
    names = list(dict.fromkeys(lines.name for lines in stage.lines))
    return [_as_one([one for _, one in sorted(found[n], key=lambda f: f[0])]) for n in names]


def _as_one(parts: Sequence[Sensitivities]) -> Sensitivities:
    """Soft and hard hits of a posture share its errors."""
    if len(parts) == 1:
        return parts[0]
    sides = [np.full(len(p.left), sign) for p, sign in zip(parts, (1.0, -1.0), strict=True)]
    return Sensitivities(
        raw=np.concatenate([p.raw for p in parts], axis=1),
        clean=np.concatenate([p.clean for p in parts], axis=1),
        left=np.concatenate([p.left for p in parts], axis=0),
        side=np.concatenate(sides),
    )


def opposed(parts: Sequence[Sensitivities]) -> list[Sensitivities]:
    """The same with the residual of hard hits turned round; empty where all hits are together.

    A model that is wrong in its form is as wrong under soft hits as under hard ones; each single
    hit is aimed badly in its own way. Turned round, the first cancels and the second is as large.
    """
    return [
        replace(part, left=part.left * part.side[:, None])
        for part in parts
        if part.side is not None
    ]


def settled(
    parts: Sequence[Sensitivities], free: npt.NDArray[np.int64], curvature: Array, pull: Array
) -> list[Sensitivities]:
    """The same with the residuals that one more step of the fit would leave.

    A fit ends where a step brings little beside what is left. Along what one posture alone tells,
    the rest of the way would be taken for what the others foretell, as well as they know it: for
    an error as many times larger as they know it worse.

    Parameters
    ----------
    curvature
        (n, n) of the free parameters over all postures (`curvature_of`).
    pull
        (n,) slope of the fit's prior, which the data's balances at the very end.
    """
    n = len(free)
    slope = pull - sum(part.raw[free].reshape(n, -1) @ part.left.reshape(-1) for part in parts)
    root = _root_of_inverse(curvature)
    step = -root.T @ (root @ slope)
    return [
        replace(part, left=part.left - np.tensordot(step, part.clean[free], axes=1))
        for part in parts
    ]


def curvature_of(parts: Sequence[Sensitivities]) -> Array:
    """(n, n) of chi^2 / 2 over all postures."""
    n = len(parts[0].raw)
    H = np.zeros((n, n))
    for part in parts:
        H += part.raw.reshape(n, -1) @ part.clean.reshape(n, -1).T
    return H


def error_slopes(
    parts: Sequence[Sensitivities], errors: Sequence[Array]
) -> list[npt.NDArray[np.complex128]]:
    """(n, K) slopes of chi^2 / 2 that each of a posture's K error modes gives, in every posture.

    Of a mode with amplitude a, complex and of unit variance, the real part of a times it.

    Parameters
    ----------
    errors
        (M, 2L) of each posture (`released`).
    """
    found = []
    for part, error in zip(parts, errors, strict=True):
        z = np.ascontiguousarray(error.astype(np.float64)).view(np.complex128)  # (M, L)
        u, size, vh = np.linalg.svd(z, full_matrices=False)
        J = np.ascontiguousarray(part.clean)
        J = J.view(np.complex64 if J.dtype == np.float32 else np.complex128)  # (n, M, L)
        n, M, L = J.shape
        along = (J.conj().transpose(0, 2, 1).reshape(n * L, M) @ u.astype(J.dtype)).reshape(
            n, L, -1
        )
        found.append(np.einsum("nlk,kl->nk", along, size[:, None] * vh))
    return found


def _root_of_inverse(curvature: Array) -> Array:
    """(n, n) R with R'R = (curvature + I)^-1.

    Derivatives are in single precision: what should be nothing beside the largest may come out
    below it.
    """
    size, Q = np.linalg.eigh((curvature + curvature.T) / 2.0)
    return np.asarray((Q / np.sqrt(np.maximum(size, 0.0) + 1.0)).T)


def released(parts: Sequence[Sensitivities], free: npt.NDArray[np.int64]) -> list[Array]:
    """(M, 2L) each posture's residual as large as its error was before the fit took its part."""
    n = len(free)
    own = []
    for part in parts:
        J, clean = (of[free].reshape(n, -1) for of in (part.raw, part.clean))
        own.append((J @ clean.T).astype(np.float64))
    root = _root_of_inverse(np.sum(own, axis=0))
    found = []
    for part, curvature in zip(parts, own, strict=True):
        h = root @ curvature @ root.T
        share, Q = np.linalg.eigh((h + h.T) / 2.0)
        share = np.clip(share, _NOTHING, 1.0 - _NOTHING)
        more = (1.0 / np.sqrt(1.0 - share) - 1.0) / share
        clean = part.clean[free].reshape(n, -1)
        slope = part.raw[free].reshape(n, -1) @ part.left.reshape(-1)
        step = root.T @ (Q @ (more * (Q.T @ (root @ slope))))
        e = part.left.reshape(-1) + step @ clean
        found.append(e.reshape(part.left.shape))
    return found
