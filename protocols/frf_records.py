"""Frequency responses as they are handed on and stored: form, units and lines travel with them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

__all__ = ["Dof", "FrequencyResponse", "FrfEstimator", "FrfForm"]


class FrfForm(StrEnum):
    """Response over force: which derivative of displacement the response is."""

    RECEPTANCE = "receptance"  # m/N
    MOBILITY = "mobility"  # m/(N s)
    ACCELERANCE = "accelerance"  # m/(N s^2)


class FrfEstimator(StrEnum):
    """Where an averaged FRF takes the noise to be."""

    H1 = "h1"  # on the response
    H2 = "h2"  # on the force
    HV = "hv"  # on both, in proportion to their power


@dataclass(frozen=True, slots=True, kw_only=True)
class Dof:
    """A measured degree of freedom: a point and a direction."""

    point: str
    label: str  # "x", "y", "z" of the sensor, or "hit"
    direction: npt.NDArray[np.float64]  # (3,) unit, base frame, at the posture as measured


@dataclass(frozen=True, slots=True, kw_only=True)
class FrequencyResponse:
    """The FRF matrix of one posture on the Laplace lines s = decay_rad_s + j 2 pi freq_hz.

    An exponential window e^(-decay t) applied alike to force and response makes the estimate the
    exact transfer function on the shifted line, so a pole found there moves back by adding
    `decay_rad_s`; nothing has to be corrected afterwards.

    What other programs did not tell of FRFs they averaged is NaN in `coherence`, 0 in `variance`
    and 0 in `n_hits`. An FRF that was not measured, such as a driving point where a sensor was in
    the way, is 0 in `values`, infinite in `variance`, NaN in `coherence` and 0 in `n_hits`.

    Attributes
    ----------
    posture : str
        Its name.
    form : FrfForm
        Response over force: receptance m/N, mobility m/(N s) or accelerance m/(N s²).
    freq_hz : (n_freq,) array
        Lines, increasing and above 0.
    decay_rad_s : float
        Real part of the lines, rad/s; 0 without an exponential window.
    values : (n_resp, n_ref, n_freq) complex array
        In the unit of `form`.
    coherence : (n_resp, n_ref, n_freq) array
        0 to 1.
    variance : (n_resp, n_ref, n_freq) array
        Expected square of the error of `values`, in the unit of `form` squared.
    n_hits : (n_resp, n_ref) int array
        How many hits were averaged.
    responses, references : tuple of Dof
        Point and direction (base frame, as measured) of each row and of each column.
    joints_rad : (n_joints,) array or None
        Joint angles as measured; None: not told.
    """

    posture: str
    form: FrfForm
    freq_hz: npt.NDArray[np.float64]
    decay_rad_s: float
    values: npt.NDArray[np.complex128]
    coherence: npt.NDArray[np.float64]
    variance: npt.NDArray[np.float64]
    n_hits: npt.NDArray[np.int64]
    responses: tuple[Dof, ...]
    references: tuple[Dof, ...]
    joints_rad: npt.NDArray[np.float64] | None

    @property
    def measured(self) -> npt.NDArray[np.bool_]:
        """Which FRFs were measured: (n_resp, n_ref)."""
        return np.asarray(~np.isposinf(self.variance).all(axis=-1))
