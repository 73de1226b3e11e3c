"""FRFs whose phases are counted the other way round.

A response follows its hit. The mean time of a response, weighted by its energy, is the mean group
delay of its FRF, and of lines `step` apart

    t = -arg( sum H(w + step) H(w)* ) / step,

known up to whole records 2 pi / step. Some programs write the transform with e^(-jwt) turned
round: the FRFs are then complex conjugates, their responses come before the hit, and no stable
mode fits them.

References
----------
Cohen, Time-Frequency Analysis (1995), Eq. (1.90): mean time from the phase's slope.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.protocols.arrays import frozen_array
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["in_time_order"]

NOTE = (
    "phases rise through the resonances, so that responses come before the hit: the file counts "
    "them the other way round; its FRFs were conjugated"
)


def in_time_order(frf: FrequencyResponse) -> tuple[FrequencyResponse, str]:
    """FRFs with responses after the hit, and what was done; nothing to say is an empty text.

    Only what surely comes before the hit is turned: a mean time in the last quarter of the
    record, which a response that is still ringing at its end does not have.
    """
    if frf.freq_hz.size < 2 or frf.decay_rad_s > 0.0:
        return frf, ""
    turn = np.angle(np.sum(frf.values[..., 1:] * frf.values[..., :-1].conj()))
    if not 0.0 < turn < np.pi / 2.0:
        return frf, ""
    return replace(frf, values=frozen_array(frf.values.conj(), np.complex128)), NOTE
