"""Mode indicators of an FRF matrix."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from protocols.errors import EstimateError
from protocols.frf_records import FrequencyResponse

__all__ = ["cmif", "frf_sum", "group_sums"]


def cmif(frf: FrequencyResponse) -> npt.NDArray[np.float64]:
    """Complex mode indicator function of an FRF matrix.

    Returns
    -------
    (n_freq, min(n_resp, n_ref)) float64
        Singular values per line, largest first, in the FRF's own unit.

    References
    ----------
    Shih et al., Mech. Syst. Signal Process. 2 (1988) 367.
    """
    values = np.linalg.svd(np.moveaxis(frf.values, 2, 0), compute_uv=False)
    return values.astype(np.float64)


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
