"""Figures of the report, as plotly figures."""

from __future__ import annotations

from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.mode_fit import MeasuredModes
from armodal.analyzer.identification.records import AxisResult
from armodal.analyzer.modal import ModalModel, group_sums, mif, synthesise, tracked_cmif
from armodal.analyzer.report.frf_choice import chosen_frfs, noisy_frfs, phase_told, shown_lines
from armodal.analyzer.report.page_text import shown
from armodal.analyzer.report.palette import DRIVEN, FAINT, MODEL, OTHER
from armodal.protocols.frf_records import FrequencyResponse, FrfForm

__all__ = ["arm_figure", "frf_figure", "indicator_figure"]

SHAPE_LENGTH_M = 0.15  # the largest motion of a mode is drawn this long
AXIS_LENGTH_M = 0.5
PHASES = 16  # pictures of one cycle of a mode
MOST_CURVES = 4  # of each indicator
CYCLES = 4  # played for one choice
UNITS = {
    FrfForm.RECEPTANCE: "m/N",
    FrfForm.MOBILITY: "m/(s N)",
    FrfForm.ACCELERANCE: "m/(s² N)",
}


def frf_figure(frf: FrequencyResponse, top_hz: float, model: ModalModel | None = None) -> Any:
    """Magnitude, phase where coherence tells it, and coherence of all FRFs of a posture.

    With the modes fitted to them, the FRFs that are meant are dark with the modes over them, all
    others faint.
    """
    keep = frf.freq_hz <= top_hz
    chosen = {} if model is None else {(i, j): what for i, j, what in chosen_frfs(frf, model)}
    colours = dict(zip(chosen, (DRIVEN, OTHER), strict=False))
    noisy = noisy_frfs(frf, keep)
    figure = make_subplots(rows=3, cols=1, shared_xaxes=True, row_heights=[0.5, 0.25, 0.25])
    order = sorted(np.ndindex(*frf.values.shape[:2]), key=lambda at: at in chosen)
    curves: list[dict[str, Any]] = []  # added at once: one by one they take twice as long
    for i, j in order:
        dof, values = frf.responses[i], frf.values[i, j, keep]
        style: dict[str, Any] = {"line": {"width": 1}}
        if model is not None:
            style["line"] = {
                "width": 2 if (i, j) in chosen else 1,
                "color": colours.get((i, j), FAINT),
            }
            style["opacity"] = 1.0 if (i, j) in chosen else 0.15 if noisy[i, j] else 0.5
        phase = np.degrees(np.angle(values))
        phase[~phase_told(frf, i, j)[keep]] = np.nan
        rows = (np.abs(values), phase, frf.coherence[i, j, keep])
        curves += [
            {
                "type": "scatter",
                **_abscissa(frf.freq_hz[keep]),
                "y": y.astype(np.float32),
                "name": _text(f"point {dof.point} {dof.label}"),
                "showlegend": False,
                "xaxis": f"x{row}",
                "yaxis": f"y{row}",
                **style,
            }
            for row, y in enumerate(rows, start=1)
        ]
    figure.add_traces(curves)
    if model is not None:
        _add_modes(figure, frf, model, top_hz, list(chosen))
    figure.update_yaxes(type="log", title=UNITS[frf.form], row=1, col=1)
    figure.update_yaxes(title="phase, deg", row=2, col=1)
    figure.update_yaxes(title="coherence", range=[0, 1.02], row=3, col=1)
    figure.update_xaxes(title="Hz", row=3, col=1)
    figure.update_layout(height=640, title=_text(f"{frf.posture}: FRFs"), margin={"t": 50})
    return figure


def _add_modes(
    figure: Any,
    frf: FrequencyResponse,
    model: ModalModel,
    top_hz: float,
    chosen: list[tuple[int, int]],
) -> None:
    """The fitted modes over the FRFs that are meant."""
    low, high = model.band_hz
    freq = frf.freq_hz[(frf.freq_hz >= low) & (frf.freq_hz <= min(high, top_hz))]
    synthesis = synthesise(model, freq, decay_rad_s=frf.decay_rad_s)
    for i, j in chosen:
        dof = frf.responses[i]
        figure.add_trace(
            go.Scatter(
                **_abscissa(freq),
                y=np.abs(synthesis[i, j]).astype(np.float32),
                name=_text(f"fitted modes, point {dof.point} {dof.label}"),
                showlegend=False,
                line={"width": 1.5, "color": MODEL, "dash": "dash"},
            ),
            row=1,
            col=1,
        )


def _abscissa(freq_hz: Any) -> dict[str, Any]:
    """Frequencies as plotly takes them: two numbers where they are evenly apart."""
    if len(freq_hz) > 1:
        step = float(freq_hz[-1] - freq_hz[0]) / (len(freq_hz) - 1)
        if np.allclose(np.diff(freq_hz), step, rtol=1e-6):
            return {"x0": float(freq_hz[0]), "dx": step}
    return {"x": freq_hz}


def indicator_figure(
    frf: FrequencyResponse, model: ModalModel, groups: dict[str, tuple[str, ...]], top_hz: float
) -> Any:
    """Sums of FRF magnitudes by group of points (file 000, Fig. 3b), CMIF curves, and the MIF."""
    keep = frf.freq_hz <= top_hz
    figure = go.Figure()

    def add(values: Any, name: str, **style: Any) -> None:
        at = np.flatnonzero(keep)[shown_lines(np.asarray(values)[keep])]
        figure.add_scatter(
            x=frf.freq_hz[at].astype(np.float32),
            y=np.asarray(values)[at].astype(np.float32),
            name=name,
            **style,
        )

    for name, values in group_sums(frf, groups).items():
        add(values, _text(f"sum of {name}"))
    for i, curve in enumerate(tracked_cmif(frf).values.T[:MOST_CURVES]):
        add(curve, f"CMIF {i + 1}", line={"dash": "dot"})
    for j, reference in enumerate(frf.references[:MOST_CURVES]):
        add(
            mif(frf)[:, j],
            _text(f"MIF, hit at {reference.point}"),
            line={"width": 1},
            yaxis="y2",
            visible="legendonly",
        )
    for mode in model.modes:
        figure.add_vline(x=mode.f_hz, line={"width": 1, "color": "#999"})
    figure.update_yaxes(type="log", title=UNITS[frf.form])
    figure.update_xaxes(title="Hz; grey lines are fitted modes")
    figure.update_layout(
        height=380,
        title=_text(f"{frf.posture}: sums by group, CMIF, MIF"),
        yaxis2={
            "overlaying": "y",
            "side": "right",
            "type": "linear",
            "range": [0, 1],
            "tickvals": [0, 0.5, 1],
            "showgrid": False,
            "title": "MIF",
        },
        legend={"x": 1.1},  # beside the second axis
    )
    return figure


def arm_figure(
    superset: Superset, frf: FrequencyResponse, model: ModalModel, axes: tuple[AxisResult, ...]
) -> Any:
    """The arm in a posture with its points, a mode shape that moves, and structural axes."""
    if frf.joints_rad is None:
        raise ValueError(f"posture '{frf.posture}' has no joint angles to draw the arm with")
    posture = superset.posture(frf.joints_rad)
    origins = np.vstack([np.zeros(3), posture.T_base_link[:, :3, 3]])
    figure = go.Figure()
    figure.add_scatter3d(
        **_xyz(origins), mode="lines", line={"width": 10, "color": "#8aa"}, name="arm"
    )
    figure.add_scatter3d(
        **_xyz(posture.point_position),
        mode="markers+text",
        text=[_text(point.id) for point in superset.arm.points],
        marker={"size": 3, "color": "#333"},
        name="points",
    )
    names = [joint.link.name for joint in superset.arm.joints]
    for axis in axes:
        T = posture.T_base_link[names.index(axis.link)]
        middle = T[:3, :3] @ axis.point_link_m + T[:3, 3]
        along = T[:3, :3] @ axis.direction_link * AXIS_LENGTH_M
        figure.add_scatter3d(
            **_xyz(np.array([middle - along, middle + along])),
            mode="lines",
            line={"width": 6, "color": "#c00"},
            name=_text(f"axis in {axis.link}"),
        )
        for row in axis.mozzi:
            if row.posture == frf.posture:
                half = row.direction_base * AXIS_LENGTH_M
                figure.add_scatter3d(
                    **_xyz(np.array([row.point_base_m - half, row.point_base_m + half])),
                    mode="lines",
                    line={"width": 3, "color": "#c60", "dash": "dash"},
                    name=f"Mozzi axis, {row.f_hz:.2f} Hz",
                )
    measured = MeasuredModes.of(superset, posture, model)
    shapes = [_motion(measured, number) for number in range(len(model.modes))]
    # The wireframe joins the points from the base outwards.
    order = np.argsort(superset.point_link, kind="stable")
    rest = posture.point_position[order]
    if shapes:
        figure.add_scatter3d(
            **_xyz(rest + shapes[0][order].real),
            mode="lines+markers",
            line={"width": 5, "color": "#06c"},
            marker={"size": 4, "color": "#06c"},
            name="mode shape",
        )
    moving = len(figure.data) - 1
    figure.frames = [
        go.Frame(
            name=f"{number}/{phase}",
            data=[
                go.Scatter3d(
                    **_xyz(rest + (shape[order] * np.exp(2j * np.pi * phase / PHASES)).real)
                )
            ],
            traces=[moving],
        )
        for number, shape in enumerate(shapes)
        for phase in range(PHASES)
    ]
    play = {"frame": {"duration": 60, "redraw": True}, "transition": {"duration": 0}}
    buttons = [
        {
            "label": f"{mode.f_hz:.2f} Hz",
            "method": "animate",
            "args": [
                [f"{number}/{phase}" for phase in range(PHASES)] * CYCLES,
                play | {"mode": "immediate"},
            ],
        }
        for number, mode in enumerate(model.modes)
    ]
    figure.update_layout(
        height=560,
        title=_text(f"{frf.posture}: arm, points, mode shape (choose a frequency to see it move)"),
        scene={"aspectmode": "data"},
        updatemenus=[{"buttons": buttons, "x": 0.0, "y": 1.0}] if buttons else [],
    )
    return figure


def _motion(measured: MeasuredModes, number: int) -> Any:
    """Complex motion (n_points, 3) in base, its largest real part drawn SHAPE_LENGTH_M long."""
    shape = measured.shapes[:, number]
    phase = np.exp(-0.5j * np.angle(np.sum(shape**2)))
    moved = np.zeros(measured.dynamics.point_position.shape, dtype=np.complex128)
    np.add.at(moved, measured.index, (shape * phase)[:, None] * measured.directions)
    return moved * SHAPE_LENGTH_M / max(float(np.linalg.norm(moved.real, axis=1).max()), 1e-30)


def _text(label: str) -> str:
    """A label as plotly shows it: it takes tags such as <b> in a text for its own."""
    return shown(label)


def _xyz(points: Any) -> dict[str, Any]:
    return {"x": points[:, 0], "y": points[:, 1], "z": points[:, 2]}
