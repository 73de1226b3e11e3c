"""Likeness and complexity of mode shapes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import EstimateError

__all__ = ["frac", "mac", "mac_matrix", "mcf", "mpc", "mpd_deg"]

_Complex = npt.NDArray[np.complex128]


def _checked(shape: npt.ArrayLike, name: str) -> _Complex:
    vector = np.asarray(shape, dtype=np.complex128)
    if vector.ndim != 1 or not np.all(np.isfinite(vector)) or not np.any(vector):
        raise EstimateError(
            f"{name} needs a finite vector that is not all zero, got an array of shape "
            f"{vector.shape}; leave the mode out"
        )
    return vector


def mac(first: npt.ArrayLike, second: npt.ArrayLike) -> float:
    """Modal assurance criterion of two shapes, in [0, 1].

    Raises
    ------
    EstimateError
        If a shape is zero, not finite, or the lengths differ.

    References
    ----------
    Allemang and Brown, Proc. IMAC I (1982) 110.

    Examples
    --------
    >>> round(mac([1, 2], [2j, 4j]), 12)
    1.0
    """
    a, b = _checked(first, "MAC"), _checked(second, "MAC")
    if a.size != b.size:
        raise EstimateError(
            f"MAC needs shapes of equal length, got {a.size} and {b.size}; use the same points"
        )
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    return float(min(np.abs(np.vdot(a, b)) ** 2, 1.0))


def mac_matrix(first: npt.ArrayLike, second: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """MAC of every column of `first` (n, a) with every column of `second` (n, b): (a, b)."""
    A = np.atleast_2d(np.asarray(first, dtype=np.complex128))
    B = np.atleast_2d(np.asarray(second, dtype=np.complex128))
    return np.array([[mac(a, b) for b in B.T] for a in A.T])


def _scatter(vector: _Complex) -> npt.NDArray[np.float64]:
    """Second moments of real and imaginary part, unit trace: (2, 2)."""
    parts = np.stack([vector.real, vector.imag]) / np.linalg.norm(vector)
    result: npt.NDArray[np.float64] = parts @ parts.T
    return result


def mpc(shape: npt.ArrayLike) -> float:
    """Modal phase collinearity in [0, 1]; 1 for a shape that is real up to a complex factor.

    (l1 - l2)^2 / (l1 + l2)^2 of the eigenvalues of the scatter of (Re, Im), taken about zero: a
    mode shape has an origin, its mean is not removed.

    References
    ----------
    Pappa, Elliott, Schenk, J. Guidance 16 (1993) 860.
    """
    S = _scatter(_checked(shape, "MPC"))
    return float(min((S[0, 0] - S[1, 1]) ** 2 + 4.0 * S[0, 1] ** 2, 1.0))


def mpd_deg(shape: npt.ArrayLike) -> float:
    """Mean phase deviation from the shape's own best line, weighted by magnitude, degrees.

    References
    ----------
    Heylen, Lammens, Sas, Modal Analysis Theory and Testing (1997), A.3.
    """
    vector = _checked(shape, "MPD")
    turned = np.abs(np.angle(to_real_axis(vector)))
    deviation = np.minimum(turned, np.pi - turned)
    return float(np.degrees(np.average(deviation, weights=np.abs(vector))))


def mcf(shape: npt.ArrayLike) -> float:
    """Modal complexity factor 1 - MPC, in [0, 1]; 0 for a real shape."""
    return 1.0 - mpc(shape)


def to_real_axis(vector: _Complex) -> _Complex:
    """The shape turned so that its best line is the real axis, largest entry positive."""
    S = _scatter(vector)
    angle = 0.5 * np.arctan2(2.0 * S[0, 1], S[0, 0] - S[1, 1])
    turned: _Complex = vector * np.exp(-1j * angle)
    return turned if turned.real[np.argmax(np.abs(vector))] >= 0.0 else -turned


def frac(first: _Complex, second: _Complex) -> npt.NDArray[np.float64]:
    """Frequency response assurance criterion along the last axis, in [0, 1]; 0 for a zero FRF.

    |sum H1 H2*|^2 / (sum |H1|^2 sum |H2|^2): likeness in shape over the lines, blind to a factor.

    References
    ----------
    Heylen and Lammens, Proc. Int. Conf. on Identification in Engineering Systems (1996) 48.
    """
    cross = np.abs(np.sum(first * np.conj(second), axis=-1)) ** 2
    size = np.sum(np.abs(first) ** 2, axis=-1) * np.sum(np.abs(second) ** 2, axis=-1)
    result: npt.NDArray[np.float64] = np.minimum(cross / np.where(size > 0.0, size, 1.0), 1.0)
    return result
