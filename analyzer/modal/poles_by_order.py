"""Poles over model orders as the search sees them: of the whole band, and of the zoomed bands."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.modal.choice import zoom_bands
from armodal.analyzer.modal.lines import fitted_lines
from armodal.analyzer.modal.modes import ModalModel
from armodal.analyzer.modal.plscf import Stabilisation, poles_plscf
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["poles_by_order"]

_ORDER_STEP = 3  # as the search steps through a zoomed band
_LEAST_ORDER = 8


def poles_by_order(frf: FrequencyResponse, model: ModalModel) -> tuple[Stabilisation, ...]:
    """Poles over orders of the whole band, then of each zoomed band.

    One polynomial over a wide band resolves its low end poorly, and a diagram of it alone would
    show no column where the search had one.

    Parameters
    ----------
    frf
        The FRFs that were fitted.
    model
        The fit, whose own table comes first.
    """
    lines = fitted_lines(frf, model.band_hz)
    values, variance = lines.values, lines.variance
    if values.shape[1] > values.shape[0]:  # by reciprocity the shorter side serves as references
        values, variance = values.swapaxes(0, 1), variance.swapaxes(0, 1)
    weight = 1.0 / np.sqrt(variance.mean(axis=1))
    highest = max(model.stabilisation.orders, default=_LEAST_ORDER)
    order = max(highest // values.shape[1], _LEAST_ORDER)
    tables = [model.stabilisation]
    for low, high in zoom_bands(lines.freq_hz):
        own = (lines.freq_hz >= low) & (lines.freq_hz <= high)
        tables.append(
            poles_plscf(
                values[..., own],
                lines.freq_hz[own],
                decay_rad_s=frf.decay_rad_s,
                weight=weight[:, own],
                max_order=min(order, int(np.count_nonzero(own)) // 2),
                order_step=_ORDER_STEP,
            )
        )
    return tuple(tables)
