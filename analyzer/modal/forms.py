"""Receptance, mobility and accelerance, and the way from one to another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.analyzer.modal.windows import laplace_lines
from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse, FrfForm

__all__ = ["convert_form", "derivative_order"]

_ORDER = {FrfForm.RECEPTANCE: 0, FrfForm.MOBILITY: 1, FrfForm.ACCELERANCE: 2}


def derivative_order(form: FrfForm) -> int:
    """How often displacement is differentiated in the response: 0, 1 or 2.

    Raises
    ------
    EstimateError
        If the form is none of the three.

    >>> derivative_order(FrfForm.MOBILITY)
    1
    """
    try:
        return _ORDER[FrfForm(form)]
    except ValueError as error:
        raise EstimateError(
            f"FRF form {form!r} is unknown, wanted one of {', '.join(FrfForm)}; "
            "say what the response is: displacement, velocity or acceleration"
        ) from error


def convert_form(frf: FrequencyResponse, form: FrfForm) -> FrequencyResponse:
    """The same FRFs in another form, on the lines they are on.

    Differentiation is multiplication by s = decay + j w, also under an exponential window; the
    variance goes with |s|^2.

    Parameters
    ----------
    frf
        FRFs of any form.
    form
        The form wanted.

    Returns
    -------
    FrequencyResponse
        In m/N, m/(N s) or m/(N s^2).

    References
    ----------
    Ewins, Modal Testing, 2nd ed. (2000), Table 2.1; s for j w by the shift theorem.
    """
    steps = derivative_order(form) - derivative_order(frf.form)
    if steps == 0:
        return frf
    factor = laplace_lines(frf.freq_hz, frf.decay_rad_s) ** float(steps)
    return replace(
        frf,
        form=FrfForm(form),
        values=frozen_array(frf.values * factor, np.complex128),
        variance=frozen_array(frf.variance * np.abs(factor) ** 2, np.float64),
    )
