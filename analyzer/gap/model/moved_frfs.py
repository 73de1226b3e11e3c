"""FRFs that were averaged elsewhere on lines further from the poles: through time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from armodal.protocols.arrays import frozen_array
from armodal.protocols.errors import EstimateError
from armodal.protocols.frf_records import FrequencyResponse, FrfForm

__all__ = ["moved_frfs"]

_NEGATIVE_TIME = 0.045  # of the record: what a taper in frequency smears before the hit
_TAPER = 0.1  # of the band, cosine, at its upper end


def moved_frfs(frf: FrequencyResponse, sigma_rad_s: float) -> FrequencyResponse:
    """Return the same FRFs as accelerance on the lines sigma + j w.

    Their variance is moved as that of white noise in time: it falls as the window's energy does.

    Raises
    ------
    EstimateError
        If lines are no multiples of their spacing, or nearer to the imaginary axis than the FRFs'.
    """
    step = float(np.median(np.diff(frf.freq_hz)))
    shift = sigma_rad_s - frf.decay_rad_s
    first = round(float(frf.freq_hz[0]) / step)
    n_lines = first + frf.freq_hz.size
    if not np.allclose(frf.freq_hz, step * np.arange(first, n_lines), atol=1e-3 * step):
        raise EstimateError(
            f"posture '{frf.posture}': wanted frequency lines that are whole multiples of their "
            "spacing, got others; export the FRFs on the analyser's own lines"
        )
    if shift < 0.0:
        raise EstimateError(
            f"posture '{frf.posture}': its exponential window is stronger than this fit wants; "
            "measure with a longer record"
        )
    s = frf.decay_rad_s + 2j * np.pi * frf.freq_hz
    power = {FrfForm.RECEPTANCE: 2, FrfForm.MOBILITY: 1, FrfForm.ACCELERANCE: 0}[frf.form]
    values = frf.values * s**power
    full = np.zeros((*values.shape[:2], n_lines), dtype=np.complex128)
    full[..., first:] = values
    # Below the band an arm on springs answers as s^2.
    low = frf.decay_rad_s + 2j * np.pi * step * np.arange(first)
    full[..., :first] = values[..., :1] * (low / s[0]) ** 2
    n_taper = max(int(_TAPER * n_lines), 1)
    full[..., -n_taper:] *= 0.5 + 0.5 * np.cos(np.pi * (np.arange(n_taper) + 0.5) / n_taper)
    n = 2 * n_lines
    impulse = np.fft.irfft(np.concatenate([full, np.zeros_like(full[..., :1])], axis=-1), n)
    time = np.arange(n) / (n * step)
    before = time > (1.0 - _NEGATIVE_TIME) / step
    time = np.where(before, time - 1.0 / step, time)
    window = np.exp(-shift * time)
    moved = np.fft.rfft(impulse * window, axis=-1)[..., first:n_lines]
    energy = float(np.mean(window**2))
    return replace(
        frf,
        form=FrfForm.ACCELERANCE,
        values=frozen_array(moved, np.complex128),
        variance=frozen_array(frf.variance * np.abs(s) ** (2 * power) * energy, np.float64),
        decay_rad_s=sigma_rad_s,
    )
