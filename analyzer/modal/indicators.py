"""Mode indicators of an FRF matrix.

Where FRFs were not measured singular values and eigenvalues are those of the largest complete
block: a hole taken for 0 would look like a second mode at every resonance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from armodal.analyzer.modal.complete_parts import complete_block
from armodal.analyzer.modal.forms import derivative_order
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse

__all__ = [
    "TrackedCmif",
    "cmif",
    "frf_sum",
    "group_sums",
    "mif",
    "multivariate_mif",
    "tracked_cmif",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackedCmif:
    """Singular values and vectors followed from line to line by their vectors.

    Curve i keeps its shape through a crossing; the curves are numbered as they rank at the first
    line.
    """

    freq_hz: npt.NDArray[np.float64]  # (n_freq,)
    values: npt.NDArray[np.float64]  # (n_freq, n), in the FRF's unit
    left: npt.NDArray[np.complex128]  # (n_freq, n_resp, n) unit vectors: shapes
    right: npt.NDArray[np.complex128]  # (n_freq, n_ref, n) unit vectors: conjugate participations


def cmif(frf: FrequencyResponse) -> npt.NDArray[np.float64]:
    """Complex mode indicator function of an FRF matrix.

    Returns
    -------
    (n_freq, min(n_resp, n_ref)) float64, those of the complete block
        Singular values per line, largest first, in the FRF's own unit.

    References
    ----------
    Shih et al., Mech. Syst. Signal Process. 2 (1988) 367.
    """
    values = np.linalg.svd(np.moveaxis(_block(frf), 2, 0), compute_uv=False)
    return values.astype(np.float64)


def tracked_cmif(frf: FrequencyResponse) -> TrackedCmif:
    """CMIF with its curves followed through crossings.

    From one line to the next the curves are paired so that the sum of
    |u_k^H u_k+1| |v_k^H v_k+1| over all pairs is largest.

    References
    ----------
    Phillips, Allemang, Fladung, Proc. IMAC XVI (1998) 705.
    """
    U, S, Vh = np.linalg.svd(np.moveaxis(_block(frf), 2, 0), full_matrices=False)
    V = Vh.conj().transpose(0, 2, 1)
    likeness = np.abs(U[:-1].conj().transpose(0, 2, 1) @ U[1:])
    likeness *= np.abs(V[:-1].conj().transpose(0, 2, 1) @ V[1:])
    order = np.empty(S.shape, dtype=np.intp)
    order[0] = np.arange(S.shape[1])
    for k, table in enumerate(likeness):
        order[k + 1] = scipy.optimize.linear_sum_assignment(table[order[k]], maximize=True)[1]
    return TrackedCmif(
        freq_hz=frf.freq_hz,
        values=frozen_array(np.take_along_axis(S, order, axis=1), np.float64),
        left=frozen_array(np.take_along_axis(U, order[:, None, :], axis=2), np.complex128),
        right=frozen_array(np.take_along_axis(V, order[:, None, :], axis=2), np.complex128),
    )


def _block(frf: FrequencyResponse) -> npt.NDArray[np.complex128]:
    """Values of the largest complete block: (n_resp, n_ref, n_freq)."""
    measured = frf.measured
    return frf.values if measured.all() else frf.values[np.ix_(*complete_block(measured))]


def _in_phase_part(
    frf: FrequencyResponse, values: npt.NDArray[np.complex128]
) -> npt.NDArray[np.complex128]:
    """FRFs turned so that the in-phase part of a real mode is real: mobility by 90 degrees."""
    turn = 1j if derivative_order(frf.form) == 1 else 1.0
    result: npt.NDArray[np.complex128] = values * turn
    return result


def mif(frf: FrequencyResponse) -> npt.NDArray[np.float64]:
    """Mode indicator function of each reference: near 0 at a real mode, near 1 between.

    Sum over responses of |Re H| |H| over sum of |H|^2, with Im for Re where H is mobility.

    Returns
    -------
    (n_freq, n_ref) float64
        In [0, 1]; 1 where all responses are zero.

    References
    ----------
    Breitbach, Proc. ESA Symp. on the Assessment of Modal Survey Test Techniques (1976).
    """
    H = _in_phase_part(frf, frf.values)
    size = np.abs(H)
    total = np.sum(size**2, axis=0)
    part = np.sum(np.abs(H.real) * size, axis=0)
    ratio = np.divide(part, total, out=np.ones_like(total), where=total > 0.0)
    result: npt.NDArray[np.float64] = ratio.T
    return result


def multivariate_mif(frf: FrequencyResponse) -> npt.NDArray[np.float64]:
    """Multivariate mode indicator functions: what forces at all references together can single out.

    Eigenvalues of (H_r^T H_r) v = lambda (H_r^T H_r + H_i^T H_i) v on each line, smallest first:
    the share of in-phase response that is left with the best force pattern. Close modes show as
    minima of the second curve.

    Returns
    -------
    (n_freq, n_ref) float64, n_ref of the complete block
        In [0, 1].

    Raises
    ------
    EstimateError
        If the references are more than the responses, so that some force pattern moves nothing.

    References
    ----------
    Williams, Crowley, Vold, Proc. IMAC III (1985) 66.
    """
    values = _block(frf)
    n_resp, n_ref, n_freq = values.shape
    if n_ref > n_resp:
        raise EstimateError(
            f"the multivariate MIF needs as many responses as references, got {n_resp} and "
            f"{n_ref}; exchange them by reciprocity"
        )
    H = np.moveaxis(_in_phase_part(frf, values), 2, 0)
    both = np.concatenate([H.real, H.imag], axis=1)
    # Whitened by the thin QR of both parts stacked, the pencil is Q_r^T Q_r.
    Q = np.linalg.qr(both)[0]
    singular = np.linalg.svd(Q[:, :n_resp], compute_uv=False)
    result: npt.NDArray[np.float64] = np.clip(singular[:, ::-1] ** 2, 0.0, 1.0)
    return result.reshape(n_freq, n_ref)


def frf_sum(frf: FrequencyResponse) -> npt.NDArray[np.float64]:
    """Sum of the magnitudes of all FRFs: (n_freq,), in the FRF's own unit."""
    result: npt.NDArray[np.float64] = np.abs(frf.values).sum(axis=(0, 1))
    return result


def group_sums(
    frf: FrequencyResponse, groups: Mapping[str, Sequence[str]]
) -> dict[str, npt.NDArray[np.float64]]:
    """Sum of FRF magnitudes over each group of points.

    A point counts where it is the roving one: as response, or as reference when there are more
    references than responses. Groups none of whose points were measured are left out.

    Parameters
    ----------
    frf
        The FRF matrix.
    groups
        Name to point ids, as the arm file has them.

    Returns
    -------
    dict of (n_freq,) float64
        In the FRF's own unit.

    Raises
    ------
    EstimateError
        If no group holds a measured point.
    """
    by_response = len(frf.responses) >= len(frf.references)
    dofs = frf.responses if by_response else frf.references
    magnitude = np.abs(frf.values).sum(axis=1 if by_response else 0)
    sums = {}
    for name, points in groups.items():
        rows = [i for i, dof in enumerate(dofs) if dof.point in points]
        if rows:
            sums[name] = magnitude[rows].sum(axis=0)
    if groups and not sums:
        raise EstimateError(
            f"none of the groups {', '.join(groups)} holds a measured point; "
            "correct the groups in the arm file"
        )
    return sums
