"""Lines near 0 Hz that hold no measurement of the structure.

Double integration and drift blow noise up there; AC coupling cuts away what is there.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.band import FEWEST_LINES
from armodal.analyzer.modal.forms import derivative_order
from armodal.analyzer.modal.noise import SMOOTHED_LINES, smooth_lines
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["first_line"]

NEAR_ZERO = 2.0  # spacings: a resonance below has less than two lines, and is none to be fitted
OUTWEIGHS = 10.0  # in amplitude: a fit of the rest is then a hundredth of the misfit
RISE = 2.0  # in amplitude: a peak begins
NOISY = 0.5  # of the roughness of pure noise: half of what is there is noise
CUT = 5.0  # in amplitude, of receptances over an octave: between two modes they rise by 3 at most
FLANK = 0.45  # of the cut-off's frequency, below which a filter of any order has fallen
FEWEST_BELOW = 4  # lines below a cut-off: of fewer, noise is as uneven
PLACES = 8  # an octave, of a cut-off: octaves are compared
PASSED = 2.0  # cut-off frequencies, from which a filter of second order takes 3 % at most

_BLOWN_UP = (
    "noise that integration, drift or AC coupling has blown up, larger than the FRFs themselves"
)
_FALLEN = (
    "what falls there from 0 Hz on, as integrated drift does, outweighs every peak; ask for a band "
    "above 0 Hz to keep them"
)
_CUT_OFF = "a filter, such as AC coupling, has cut away what was there"


def first_line(frf: FrequencyResponse, *, told: bool) -> tuple[int, str]:
    """First line to be fitted, and why those below are not; 0 for all lines.

    Parameters
    ----------
    frf
        FRFs of any form.
    told
        Whether a variance came with them.
    """
    blown_up, cut = _blown_up(frf.values), _cut_off(frf)
    # Told of its noise, a fit gives drift no more weight than it has.
    fallen = 0 if told else _fallen(frf)
    found = ((blown_up, _BLOWN_UP), (cut, _CUT_OFF), (fallen, _FALLEN))
    return max(found, key=lambda one: one[0])


def _cut_off(frf: FrequencyResponse) -> int:
    """First line above a high-pass filter's edge; 0 where there is none.

    Below the first resonance receptances are flat, whatever the structure, and above it they fall.
    If they stand several times higher on every line of an octave than on every line of an octave
    further down, a filter has cut them. A variance in proportion to what the filter has left would
    give those lines more weight than all others.
    """
    freq = frf.freq_hz
    if freq[0] > NEAR_ZERO * float(np.median(np.diff(freq))):
        return 0
    omega = 2.0 * np.pi * freq
    power = np.abs(frf.values[frf.measured]) ** 2 / omega ** (2 * derivative_order(frf.form))
    power /= np.maximum(np.median(power, axis=-1, keepdims=True), 1e-12 * float(power.max()))
    level = power.mean(axis=0)
    edge = 0
    last = int(np.searchsorted(freq, freq[-1] / 2.0))
    tried = np.geomspace(FEWEST_BELOW, max(last, FEWEST_BELOW), PLACES * freq.size.bit_length())
    for k in np.unique(tried.astype(np.intp)):
        above = level[k : int(np.searchsorted(freq, 2.0 * freq[k], side="right"))]
        low, high = np.searchsorted(freq, (FLANK / 2.0 * freq[k], FLANK * freq[k]))
        below = level[int(low) : max(int(high), int(low) + 1)]
        if below.max() * CUT**2 < above.min():
            edge = int(k)
    passed = int(np.searchsorted(freq, PASSED * freq[edge])) if edge else 0
    return passed if freq.size - passed >= FEWEST_LINES else 0


def _blown_up(values: npt.NDArray[np.complex128]) -> int:
    """First line that carries a measurement; above 0 where noise near 0 Hz exceeds the FRFs."""
    power = np.abs(values) ** 2
    size = np.median(power, axis=-1, keepdims=True)
    power /= np.maximum(size, 1e-12 * float(power.max()))
    level = power.sum(axis=(0, 1))
    # Of noise the squared second difference is its neighbours' power, of what is smooth nothing.
    rough = np.abs(values[..., :-2] - 2.0 * values[..., 1:-1] + values[..., 2:]) ** 2
    rough /= np.maximum(size, 1e-12 * float(np.abs(values).max() ** 2))
    full = power[..., :-2] + 4.0 * power[..., 1:-1] + power[..., 2:]
    near = smooth_lines(np.stack([rough.sum(axis=(0, 1)), full.sum(axis=(0, 1))]), 1)
    noisy = near[0] > NOISY * near[1]
    if not noisy[0]:
        return 0
    # A second difference reaches one line further than its middle.
    end = 2 + (int(np.argmin(noisy)) if not noisy.all() else noisy.size)
    if level.size - end < FEWEST_LINES or level[:end].max() < level[end:].max():
        return 0
    return end


def _fallen(frf: FrequencyResponse) -> int:
    """First line to be fitted; above 0 where what falls from 0 Hz on outweighs every peak.

    Drift integrated twice falls smoothly. With no variance told it has all the weight.
    """
    spacing = float(np.median(np.diff(frf.freq_hz)))
    if frf.freq_hz[0] > NEAR_ZERO * spacing:
        return 0  # the flank of a mode below the band is its own
    power = np.abs(frf.values[frf.measured]) ** 2
    power /= np.maximum(np.median(power, axis=-1, keepdims=True), 1e-12 * float(power.max()))
    level = smooth_lines(power.mean(axis=0), SMOOTHED_LINES)
    lowest = np.minimum.accumulate(level)
    rising = level > RISE**2 * lowest
    valley = int(np.argmin(level[: int(np.argmax(rising))])) if rising.any() else 0
    beyond = np.maximum.accumulate(level[::-1])[::-1]
    peak = float(beyond[valley])
    end = int(np.argmax(level <= peak))
    if level.size - end < FEWEST_LINES or level[0] < OUTWEIGHS**2 * peak:
        return 0
    return end
