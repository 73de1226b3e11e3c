"""A shaper as pictures: a step before and after, and what each kind leaves by frequency."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go
import scipy.signal

from armodal.analyzer.acting.robust import Candidate, ModeBox
from armodal.analyzer.report.policy import under_policy

__all__ = ["residual_figure", "shaper_page", "step_figure", "step_response"]

Array = npt.NDArray[np.float64]

_PERIODS = 12.0  # of the slowest mode that are shown
_SAMPLES = 1200
_BESIDE = 0.3  # of a mode's middle frequency, drawn on both sides


def step_response(own: Candidate | None, f_hz: float, damping_ratio: float, time_s: Array) -> Array:
    """Return how a mode follows a step of the command, through a shaper, notches, or neither.

    x'' + 2 zeta w x' + w^2 x = w^2 u (Singer and Seering, J. Dyn. Syst. Meas. Control 112 (1990)
    76, Eq. (1), of an impulse).

    Parameters
    ----------
    time_s
        (n,) even, the first zero.
    """
    w = 2.0 * np.pi * f_hz
    if own is not None and own.shaper is None:
        above, below = np.array([w**2]), np.array([1.0, 2.0 * damping_ratio * w, w**2])
        for notch in own.notches:
            w0 = 2.0 * np.pi * notch.f_hz
            above = np.polymul(above, [1.0, 2.0 * notch.zero_damping * w0, w0**2])
            below = np.polymul(below, [1.0, 2.0 * notch.pole_damping * w0, w0**2])
        return np.asarray(scipy.signal.step((above, below), T=time_s)[1])

    def plain(after: Array) -> Array:
        t = np.maximum(after, 0.0)
        root = np.sqrt(1.0 - damping_ratio**2)
        turn = w * root * t
        swing = np.cos(turn) + damping_ratio / root * np.sin(turn)
        return np.asarray((after >= 0.0) * (1.0 - np.exp(-damping_ratio * w * t) * swing))

    if own is None or own.shaper is None:
        return plain(time_s)
    parts = zip(own.shaper.amplitude, own.shaper.time_s, strict=True)
    return np.asarray(sum(a * plain(time_s - t) for a, t in parts))


def step_figure(boxes: Sequence[ModeBox], best: Candidate) -> Any:
    """A step, every mode with an equal part: unshaped, shaped, and shaped anywhere in the boxes."""
    period = 1.0 / min(box.f_hz[0] for box in boxes)
    time = np.linspace(0.0, _PERIODS * period, _SAMPLES)

    def whole(own: Candidate | None, at: Sequence[tuple[float, float]]) -> Array:
        every = [step_response(own, f, z, time) for f, z in at]
        return np.asarray(np.mean(every, axis=0))

    middle = [(float(np.mean(box.f_hz)), float(np.mean(box.damping_ratio))) for box in boxes]
    corners = [
        [(box.f_hz[i], box.damping_ratio[j]) for box in boxes] for i in (0, 1) for j in (0, 1)
    ]
    anywhere = [whole(best, at) for at in [middle, *corners]]
    figure = go.Figure()
    t = (1e3 * time).round(3)
    figure.add_scatter(x=t, y=whole(None, middle), name="unshaped", line={"color": "#d55e00"})
    for edge, fill in ((np.max(anywhere, axis=0), None), (np.min(anywhere, axis=0), "tonexty")):
        figure.add_scatter(
            x=t,
            y=edge,
            name="ends of the intervals",
            showlegend=fill is not None,
            line={"width": 0.0},
            fillcolor="rgba(0, 114, 178, 0.3)",
            fill=fill,
        )
    figure.add_scatter(x=t, y=whole(best, middle), name=best.kind, line={"color": "#0072b2"})
    figure.update_xaxes(title="ms")
    figure.update_yaxes(title="follows a step of 1")
    figure.update_layout(title=f"A step before and after {best.kind}")
    return figure


def residual_figure(boxes: Sequence[ModeBox], every: Sequence[Candidate], limit: float) -> Any:
    """What each kind leaves of a mode of any frequency, its damping in the middle; boxes shaded."""
    figure = go.Figure()
    low = (1.0 - _BESIDE) * min(box.f_hz[0] for box in boxes)
    high = (1.0 + _BESIDE) * max(box.f_hz[1] for box in boxes)
    f = np.linspace(low, high, 600)
    zeta = np.interp(f, [np.mean(b.f_hz) for b in boxes], [np.mean(b.damping_ratio) for b in boxes])
    for own in every:
        filters = own.notches if own.shaper is None else (own.shaper,)
        left = np.prod([one.residual(f, zeta) for one in filters], axis=0)
        figure.add_scatter(x=f.round(4), y=100.0 * left, name=own.kind)
    for box in boxes:
        figure.add_vrect(x0=box.f_hz[0], x1=box.f_hz[1], fillcolor="gray", opacity=0.25)
    figure.add_hline(y=100.0 * limit, line={"dash": "dot", "width": 1})
    figure.update_xaxes(title="Hz")
    figure.update_yaxes(title="left, % of unshaped", range=[0.0, 100.0])
    figure.update_layout(title="Vibration left; shaded is what the modes may be (95 %)")
    return figure


def shaper_page(name: str, figures: Sequence[Any], words: Sequence[str]) -> str:
    """Return a self-contained page."""
    body = "\n".join(
        figure.to_html(full_html=False, include_plotlyjs=number == 0)
        for number, figure in enumerate(figures)
    )
    said = "".join(f"<p>{escape(text)}</p>" for text in words)
    return under_policy(
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(name)}: shaper</title></head>\n"
        f'<body style="font-family:sans-serif;max-width:70rem;margin:auto">{said}{body}'
        "</body></html>\n"
    )
