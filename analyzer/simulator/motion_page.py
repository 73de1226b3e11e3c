"""A logged trajectory as a page: measured, plain and corrected arm, in time and by frequency."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy
from plotly.subplots import make_subplots

from armodal.analyzer.report.policy import under_policy
from armodal.analyzer.simulator.motion import PointComparison

__all__ = ["motion_figure", "motion_page"]

Array = npt.NDArray[np.float64]

_PERIODS = 6.0  # of the band's low end that are shown in time, about the largest reading
_SEGMENTS = 8.0  # of the log, whose spectra are averaged


def motion_figure(row: PointComparison) -> Any:
    """Return a reading where it is largest; by frequency, it and what each arm is off it."""
    figure = make_subplots(rows=2, cols=1, vertical_spacing=0.16)
    measured = row.measured_m_s2
    half = 0.5 * _PERIODS / row.band_hz[0]
    middle = row.time_s[int(np.argmax(np.abs(measured)))]
    shown = np.abs(row.time_s - middle) <= half
    for label, values, colour in (
        ("measured", measured, "#222222"),
        ("plain arm", row.before_m_s2, "#d55e00"),
        ("corrected arm", row.after_m_s2, "#0072b2"),
    ):
        of_all = label == "measured"
        f_hz, density = _density(values if of_all else values - measured, row)
        line = {"color": colour, "width": 3.0 if of_all else 1.5}
        figure.add_scatter(
            x=row.time_s[shown].round(6), y=values[shown], name=label, line=line, row=1, col=1
        )
        figure.add_scatter(
            x=f_hz,
            y=density,
            name=label if of_all else f"{label}, off",
            line=line | {"dash": "solid" if of_all else "dot"},
            showlegend=not of_all,
            row=2,
            col=1,
        )
    figure.update_xaxes(title="s", row=1, col=1)
    figure.update_xaxes(title="Hz", row=2, col=1)
    figure.update_yaxes(title="m/s²", row=1, col=1)
    figure.update_yaxes(title="m/(s² √Hz)", type="log", exponentformat="power", row=2, col=1)
    figure.update_layout(
        title=f"Point {row.point} {'xyz'[row.axis]}: plain arm {100 * row.error_before:.1f} % off, "
        f"corrected arm {100 * row.error_after:.1f} %",
        height=620,
    )
    return figure


def _density(values: Array, row: PointComparison) -> tuple[Array, Array]:
    """Root of the spectral density in the band."""
    rate_hz = 1.0 / float(row.time_s[1] - row.time_s[0])
    f_hz, square = scipy.signal.welch(values, rate_hz, nperseg=int(2 * len(values) / _SEGMENTS))
    inside = (f_hz >= row.band_hz[0]) & (f_hz <= row.band_hz[1])
    return f_hz[inside], np.sqrt(square[inside])


def motion_page(name: str, rows: Sequence[PointComparison], words: Sequence[str]) -> str:
    """Return a self-contained page."""
    body = "\n".join(
        motion_figure(row).to_html(full_html=False, include_plotlyjs=number == 0)
        for number, row in enumerate(rows)
    )
    said = "".join(f"<p>{escape(text)}</p>" for text in words)
    return under_policy(
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(name)}: trajectory</title></head>\n"
        f'<body style="font-family:sans-serif;max-width:70rem;margin:auto">{said}{body}'
        "</body></html>\n"
    )
