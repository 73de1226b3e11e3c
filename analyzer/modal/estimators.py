"""H1, H2 and Hv: one FRF from several records, by where the noise is taken to be.

H1 puts all noise on the response, H2 all on the force, Hv on both in proportion to their power.
With noise only where each one says it is, each is unbiased; always |H1| <= |Hv| <= |H2|.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.protocols.frf_records import FrfEstimator

__all__ = ["single_reference"]

_Complex = npt.NDArray[np.complex128]
_Real = npt.NDArray[np.float64]
_TINY = float(np.finfo(float).tiny)


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
