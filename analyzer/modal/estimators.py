"""H1, H2 and Hv: one FRF from several records, by where the noise is taken to be.

H1 puts all noise on the response, H2 all on the force, Hv on both in proportion to their power.
With noise only where each one says it is, each is unbiased; always |H1| <= |Hv| <= |H2|.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrfEstimator

__all__ = ["FrfEstimate", "estimate_frf", "single_reference"]

_Complex = npt.NDArray[np.complex128]
_Real = npt.NDArray[np.float64]
_TINY = float(np.finfo(float).tiny)
_LEAST_CONDITION = 1e-10  # of smallest over largest eigenvalue of the forces' spectral matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class FrfEstimate:
    """FRFs with what the averages say of their noise."""

    values: _Complex  # (n_resp, n_ref, n_freq)
    coherence: _Real  # (n_resp, n_freq), multiple coherence
    variance: (
        _Real  # (n_resp, n_ref, n_freq), E|error|^2 by the scatter of the records; nan if none
    )


def single_reference(
    estimator: FrfEstimator, power_force: _Real, power_response: _Real, cross: _Complex
) -> tuple[_Complex, _Real]:
    """Estimate and ordinary coherence from summed spectra of one force.

    Parameters
    ----------
    estimator
        H1 = G_xf / G_ff, H2 = G_xx / G_fx, Hv = sqrt(G_xx / G_ff) e^(j arg G_xf).
    power_force, power_response
        sum |F|^2 and sum |X|^2, shapes that broadcast.
    cross
        sum X F*.

    References
    ----------
    Bendat and Piersol, Random Data, 4th ed. (2010), Eqs. (6.37), (6.42), (6.44); Hv: Rocklin,
    Crowley, Vold, Proc. IMAC III (1985) 272.
    """
    coherence = np.clip(
        np.abs(cross) ** 2 / np.maximum(power_force * power_response, _TINY), 0.0, 1.0
    )
    size = np.maximum(np.abs(cross), _TINY)
    direction = cross / size
    if estimator is FrfEstimator.H1:
        value = cross / power_force
    elif estimator is FrfEstimator.H2:
        value = power_response / size * direction
    else:
        value = np.sqrt(power_response / power_force) * direction
    return value, coherence


def estimate_frf(
    force: _Complex, response: _Complex, estimator: FrfEstimator = FrfEstimator.H1
) -> FrfEstimate:
    """FRF matrix from records in which one or several forces act at once.

    Parameters
    ----------
    force
        (n_records, n_ref, n_freq) spectra.
    response
        (n_records, n_resp, n_freq) spectra.
    estimator
        H1 = G_XF G_FF^-1. H2 = G_XX G_FX^+, response by response where there is one force; with
        several it needs as many responses as forces. Hv, response by response: the eigenvector
        of the smallest eigenvalue of the spectral matrix of all forces and the response, each
        scaled to unit power.

    Returns
    -------
    FrfEstimate
        Variance from sum |X - H F|^2 / (n_records - n_ref) times the diagonal of G_FF^-1.

    Raises
    ------
    EstimateError
        If there are fewer records than forces, the forces are dependent on some line, or H2 has
        fewer responses than forces.

    References
    ----------
    Bendat and Piersol, Random Data, 4th ed. (2010), ch. 7. Hv: Rocklin, Crowley, Vold, Proc.
    IMAC III (1985) 272. H2 of several forces: Allemang and Brown, Harris' Shock and Vibration
    Handbook, 6th ed. (2010), ch. 21.
    """
    n, n_ref, _ = force.shape
    n_resp = response.shape[1]
    if n < n_ref:
        raise EstimateError(
            f"FRFs from {n_ref} forces at once need at least as many records, got {n}; record more"
        )
    F, X = np.moveaxis(force, 2, 0), np.moveaxis(response, 2, 0)  # (n_freq, n, .)
    Fh = F.conj()
    GFF = np.einsum("kni,knj->kij", F, Fh)
    GXF = np.einsum("kno,knj->koj", X, Fh)
    scale = np.sqrt(np.maximum(np.einsum("kii->ki", GFF).real, _TINY))
    scaled = GFF / (scale[:, :, None] * scale[:, None, :])
    if np.any(np.linalg.eigvalsh(scaled)[:, 0] < _LEAST_CONDITION):
        raise EstimateError(
            "the forces are dependent on at least one line, so that their effects cannot be told "
            "apart; use records with different force patterns"
        )
    inverse = np.linalg.inv(scaled) / (scale[:, :, None] * scale[:, None, :])
    H1 = GXF @ inverse
    power = np.maximum(np.einsum("kno,kno->ko", X, X.conj()).real, _TINY)
    explained = np.einsum("koj,koj->ko", H1, GXF.conj()).real
    if estimator is FrfEstimator.H1:
        H = H1
    elif n_ref == 1:
        H, _ = single_reference(estimator, GFF.real, power[:, :, None], GXF)
    elif estimator is FrfEstimator.H2:
        if n_resp < n_ref:
            raise EstimateError(
                f"H2 of {n_ref} forces needs as many responses, got {n_resp}; use H1 or Hv"
            )
        GXX = np.einsum("kno,knp->kop", X, X.conj())
        H = GXX @ np.linalg.pinv(GXF.conj().transpose(0, 2, 1))
    else:
        H = _total_least_squares(scaled, GXF, scale, power)
    left = np.einsum("kno->ko", np.abs(X - F @ H.transpose(0, 2, 1)) ** 2)
    free = n - n_ref
    noise = left / free if free else np.full(left.shape, np.nan)
    variance = noise[:, :, None] * np.einsum("kii->ki", inverse).real[:, None, :]
    return FrfEstimate(
        values=np.ascontiguousarray(np.moveaxis(H, 0, 2)),
        coherence=np.clip(explained / power, 0.0, 1.0).T,
        variance=np.ascontiguousarray(np.moveaxis(variance, 0, 2)),
    )


def _total_least_squares(scaled: _Complex, GXF: _Complex, scale: _Real, power: _Real) -> _Complex:
    """Hv of every response: (n_freq, n_resp, n_ref).

    With y = (f_1 .., x) scaled to unit power and v the eigenvector of the least power,
    v^H y = 0, so that x = -sum conj(v_f / v_x) f.
    """
    n_freq, n_resp, n_ref = GXF.shape
    root = np.sqrt(power)
    G = np.empty((n_freq, n_resp, n_ref + 1, n_ref + 1), dtype=np.complex128)
    G[:, :, :n_ref, :n_ref] = scaled[:, None]
    cross = GXF / (root[:, :, None] * scale[:, None, :])
    G[:, :, n_ref, :n_ref] = cross
    G[:, :, :n_ref, n_ref] = cross.conj()
    G[:, :, n_ref, n_ref] = 1.0
    v = np.linalg.eigh(G)[1][..., 0]
    result: _Complex = (
        -(v[..., :n_ref] / v[..., n_ref:]).conj() * root[:, :, None] / scale[:, None, :]
    )
    return result
