"""FRFs of a posture for print: what was measured, and the fitted modes over it."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from armodal.analyzer.modal import ModalModel, synthesise
from armodal.analyzer.report.figures import UNITS
from armodal.analyzer.report.frf_choice import chosen_frfs, noisy_frfs, phase_told
from armodal.analyzer.report.palette import DRIVEN, FAINT, MODEL, OTHER
from armodal.analyzer.report.svg_plot import Curve, Panel, panels_figure
from armodal.protocols.frf_records import FrequencyResponse

__all__ = ["frf_svg"]

Array = npt.NDArray[np.float64]

MOST_FAINT = 60  # FRFs beside the chosen: more are one grey
_MOST_POINTS = 400  # of a curve: more than a printed figure has dots across
_HEIGHTS = (150.0, 62.0, 50.0)


def frf_svg(frf: FrequencyResponse, model: ModalModel, top_hz: float) -> str:
    """Magnitude, phase and coherence up to `top_hz`: the chosen FRFs dark, all others faint."""
    low_hz = float(frf.freq_hz[0])
    top_hz = max(min(top_hz, float(frf.freq_hz[-1])), low_hz * 1.01)
    keep = frf.freq_hz <= top_hz
    freq = frf.freq_hz[keep]
    chosen = chosen_frfs(frf, model)
    size = np.abs(frf.values[..., keep])
    noisy, dark = noisy_frfs(frf, keep), {(i, j) for i, j, _ in chosen}
    beside = [
        (i, j) for i, j in np.ndindex(*size.shape[:2]) if frf.measured[i, j] and (i, j) not in dark
    ]
    faint = [
        _thinned(
            Curve(
                x=freq,
                y=size[i, j],
                colour=FAINT,
                width=0.7,
                opacity=0.12 if noisy[i, j] else 0.4,
            )
        )
        for i, j in beside[:: math.ceil(len(beside) / MOST_FAINT) or 1]
    ]
    within = freq[(freq >= model.band_hz[0]) & (freq <= model.band_hz[1])]
    synthesis = synthesise(model, within, decay_rad_s=frf.decay_rad_s)
    magnitude, phase, coherence = list(faint), [], []
    for (i, j, what), colour in zip(chosen, (DRIVEN, OTHER), strict=False):
        one, other = frf.responses[i], frf.references[j]
        name = f"{one.point} {one.label} over {other.point} {other.label}, {what}"
        magnitude.append(_thinned(Curve(x=freq, y=size[i, j], colour=colour, name=name, width=1.8)))
        told = np.degrees(np.angle(frf.values[i, j, keep]))
        told[~phase_told(frf, i, j)[keep]] = np.nan
        phase.append(_thinned(Curve(x=freq, y=_unjoined(told), colour=colour, width=1.2)))
        if np.isfinite(frf.coherence[i, j]).any():
            found = frf.coherence[i, j, keep]
            coherence.append(_thinned(Curve(x=freq, y=found, colour=colour, width=1.2)))
    for number, (i, j, _) in enumerate(chosen):
        curve = np.abs(synthesis[i, j])
        magnitude.append(
            _thinned(
                Curve(
                    x=within,
                    y=curve,
                    colour=MODEL,
                    name="fitted modes" if number == 0 else "",
                    width=1.2,
                    dash="5 3",
                )
            )
        )
    panels = [
        Panel(
            curves=tuple(magnitude),
            height=_HEIGHTS[0],
            label=UNITS[frf.form],
            y_range=_decade_range(size[frf.measured]),
            log=True,
        ),
        Panel(
            curves=tuple(phase),
            height=_HEIGHTS[1],
            label="phase, °",
            y_range=(-180.0, 180.0),
            ticks=(-180.0, 0.0, 180.0),
        ),
    ]
    if coherence:
        panels.append(
            Panel(
                curves=tuple(coherence),
                height=_HEIGHTS[2],
                label="coherence",
                y_range=(0.0, 1.0),
                ticks=(0.0, 0.5, 1.0),
            )
        )
    return panels_figure(
        panels,
        (low_hz, top_hz),
        x_label="Hz (dotted: fitted modes)",
        title=f"FRFs of {frf.posture}",
        verticals=[mode.f_hz for mode in model.modes],
    )


def _unjoined(phase_deg: Array) -> Array:
    """The phase with a gap where it passes from 180 to -180 degrees."""
    joined = phase_deg.copy()
    joined[1:][np.abs(np.diff(phase_deg)) > 180.0] = np.nan
    return joined


def _thinned(curve: Curve) -> Curve:
    """The curve with the least and the largest of every stretch, _MOST_POINTS in all at most."""
    if len(curve.x) <= _MOST_POINTS:
        return curve
    edges = np.linspace(0, len(curve.x), _MOST_POINTS // 2 + 1).astype(int)
    kept = sorted(
        {
            int(first + at(np.nan_to_num(curve.y[first:end])))
            for first, end in pairwise(edges)
            for at in (np.argmin, np.argmax)
        }
    )
    return replace(curve, x=curve.x[kept], y=curve.y[kept])


def _decade_range(size: Array) -> tuple[float, float]:
    """Whole decades about what was measured: four, or down to a decade below the median."""
    positive = size[size > 0.0]
    if not positive.size:
        return 0.1, 1.0
    high = float(np.ceil(np.log10(positive.max())))
    low = float(np.floor(np.log10(np.percentile(positive, 1.0))))
    middle = float(np.floor(np.log10(np.median(positive))))
    low = max(low, min(high - 4.0, middle - 1.0))
    return 10.0**low, 10.0**high if high > low else 10.0 ** (low + 1.0)
