"""The impulse of a hit, which is what moves a joint; its peak and width tell it only nearly."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.modal.spectra import active_channels
from armodal.protocols.session.records import Hit, Session

__all__ = ["IMPULSE_OF_SINE", "WIDTH_OF_SINE", "impulse_n_s"]

WIDTH_OF_SINE = 1.5  # a half sine's length over its width at half the peak
IMPULSE_OF_SINE = 2.0 / np.pi * WIDTH_OF_SINE  # over its peak and that width
_WIDTHS = 2  # to each side of the peak: a pulse ends there, what a filter makes of its ends too


def impulse_n_s(session: Session, hit: Hit) -> float:
    """Return the force over time of a hit's pulse in N s, along the hit.

    From its offset before the pulse. A record that begins within the pulse, or holds nothing that
    pushes there, has the impulse of a half sine with its peak and width.

    Parameters
    ----------
    hit
        Judged, with a width.
    """
    force, _, columns = active_channels(session)
    rate = float(session.header.plan.sampling.rate_hz)
    pushes = hit.verdict.polarity * force.scale * hit.counts[:, columns[0]].astype(np.float64)
    around = max(round(_WIDTHS * hit.verdict.width_s * rate), 1)
    trigger = max(int(hit.trigger_sample - hit.first_sample), 0)
    peak = trigger + int(np.argmax(pushes[trigger : trigger + 2 * around]))
    begin = peak - around
    if begin > 0:
        impulse = float(np.sum(pushes[begin : peak + around + 1] - np.mean(pushes[:begin]))) / rate
        if impulse > 0.0:
            return impulse
    return IMPULSE_OF_SINE * hit.verdict.peak_n * hit.verdict.width_s
