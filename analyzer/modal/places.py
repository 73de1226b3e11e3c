"""Modes that have no place: what the FRFs tell of their frequency is less than a resonance says."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.modes import Mode

__all__ = ["without_place"]

_LINES = 2.0  # a resonance narrower than a line is placed by lines


def without_place(modes: Sequence[Mode], line_hz: float) -> npt.NDArray[np.bool_]:
    """Which modes' frequency is less well known than their width: (n_modes,).

    By two half bandwidths, or by one where the width is not known either.

    Parameters
    ----------
    modes
        With their standard deviations.
    line_hz
        Distance of the lines.
    """
    told = [(m.f_std_hz, m.damping_std, m.damping_ratio, m.f_hz) for m in modes]
    f_std, std, damping, f_hz = np.array(told).reshape(-1, 4).T
    half = damping * f_hz
    most = np.where(std > damping, half, 2.0 * half) + _LINES * line_hz
    result: npt.NDArray[np.bool_] = f_std > most
    return result
