"""What is no mode and no polynomial: flanks of resonances beyond a band, broad rises within it.

The expansions that stand for modes far off (`regression`) do not hold the flank of a resonance that
the band cuts, nor a rise of many overlapping modes. Left over, either pulls modes off their own
resonances. A pole beyond the band, or damped more than a structure can be, that explains it stays
in the fit and is not told as a mode.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal.choice import MOST_DAMPING, physical
from armodal.analyzer.modal.refine import refine_poles
from armodal.analyzer.modal.regression import ModalData, Regression, modal_data, regress
from armodal.analyzer.modal.significance import LEAST_SIGNIFICANCE, noise_about, significance

__all__ = ["background_note", "with_background_found"]

_Complex = npt.NDArray[np.complex128]

_LEAST_PROGRESS = 0.95  # of the misfit without one more
_ROUNDING = 1e-12  # of the FRFs' weighted squares, below which nothing is left over
_COARSE = 400  # lines that tell which are promising
_BROAD = 8  # poles tried within the band, each as wide as the next is far
_BEYOND = (1.02, 1.1, 1.5)  # times the band's upper end, or parts of its lower one


def with_background_found(
    data: ModalData, poles: _Complex, band_hz: tuple[float, float], *, line_share: float
) -> tuple[_Complex, _Complex]:
    """Modes refined beside a background, and its poles: (n_modes,) and (n_background,).

    One more is taken as long as the misfit falls by it, all are refined together, and what was
    taken as background does not become a mode.

    Parameters
    ----------
    data
        FRFs weighted by one over their variance.
    poles
        (n_modes,) of the modes.
    band_hz
        Where modes may lie.
    line_share
        Independent lines per line under the window.
    """
    fit, n = regress(data, poles, pole_terms=False), poles.size
    coarse = _coarse(data)
    while True:
        more = _with_one_more(data, coarse, fit, n, band_hz, line_share)
        if more is None:
            return fit.poles[:n], fit.poles[n:]
        fit = more


def background_note(background: _Complex) -> list[str]:
    """What was fitted beside the modes and is none of them, if anything."""
    if not background.size:
        return []
    listed = ", ".join(
        f"{abs(p) / (2.0 * np.pi):.4g} Hz, {'broad' if _is_broad(p) else 'beyond the band'}"
        for p in sorted(background, key=abs)
    )
    return [f"beside the modes a background is fitted, which is none of them: {listed}"]


def _is_broad(pole: complex) -> bool:
    return -pole.real >= MOST_DAMPING * abs(pole)


def _coarse(data: ModalData) -> ModalData:
    """A line in so many: what is broad is seen on few."""
    at = slice(None, None, max(data.s.size // _COARSE, 1))
    return modal_data(data.form, data.s[at], data.values[:, at], data.variance_on(at))


def _with_one_more(
    data: ModalData,
    coarse: ModalData,
    fit: Regression,
    n: int,
    band_hz: tuple[float, float],
    line_share: float,
) -> Regression | None:
    """The fit with another background pole behind the `n` modes; None where none is worth it."""
    if float(fit.cost.sum()) <= _ROUNDING * float(data.energy.sum()):
        return None
    tried = [np.append(fit.poles, one) for one in _tried(band_hz)]
    costs = [float(regress(coarse, one, pole_terms=False).cost.sum()) for one in tried]
    before = float(regress(coarse, fit.poles, pole_terms=False).cost.sum())
    for start in np.argsort(costs):
        if costs[start] > _LEAST_PROGRESS * before:
            return None
        more = refine_poles(data, tried[start])
        mode = physical(more.poles, band_hz)
        if not mode[:n].all() or mode[n:].any():
            continue
        told = significance(more, noise_about(data, more), line_share)
        falls = float(more.cost.sum()) < _LEAST_PROGRESS * float(fit.cost.sum())
        if falls and told.min() >= LEAST_SIGNIFICANCE:
            return more
    return None


def _tried(band_hz: tuple[float, float]) -> _Complex:
    """Poles on either side of the band, and broad ones within it."""
    low, high = band_hz
    within = np.geomspace(low, high, _BROAD)
    damping = np.full(within.size, 1.2 * MOST_DAMPING)
    f = np.concatenate([within, high * np.array(_BEYOND), low / np.array(_BEYOND)])
    zeta = np.concatenate([damping, np.full(2 * len(_BEYOND), 0.02)])
    w = 2.0 * np.pi * f
    poles: _Complex = w * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    return poles
