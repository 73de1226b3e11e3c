"""`armodal gap --simulator mujoco`: hits, or a trajectory, in the user's own simulator."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
from rich.table import Table

from armodal.analyzer.export.by_mujoco import load_mujoco
from armodal.analyzer.report.policy import under_policy
from armodal.analyzer.simulator.comparison import PostureComparison, compare_with_simulator
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError, SessionError
from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.text_file import replace_text
from armodal.tui.command_parts.gap_motion import show_motion
from armodal.tui.console import out, print_json, say, say_next
from armodal.tui.output_file import check_output

__all__ = ["show_simulator"]


def show_simulator(
    session: Path | None,
    arm: str | None,
    simulator: str | None,
    model: Path | None,
    motion: Path | None,
    topics: Sequence[str],
    html: Path | None,
    *,
    as_json: bool,
) -> None:
    """Simulate hits, or a log of motion, with the session's own arm and the corrected one.

    Raises
    ------
    SessionError, ArmError, EstimateError, ForeignFileError
        If something is missing, the log is faulty, or the model is not of this arm.
    """
    session, model, corrected = _wanted(session, arm, simulator, model)
    if topics and motion is None:
        raise SessionError("wanted --topic with --motion only, got it without; leave it out")
    if html is not None:
        read = [] if arm is None else [Path(arm)]
        check_output(html, session, model, *read, *([] if motion is None else [motion]))
    measured = read_session(session)
    if motion is not None:
        own = measured.header.arm
        show_motion(own, corrected, model, motion, topics, html, as_json=as_json)
        return
    rows = compare_with_simulator(
        measured, measured.header.arm, corrected, model, load_mujoco(), say
    )
    if html is not None:
        replace_text(html, _page(corrected.name, rows))
    if as_json:
        print_json({"arm": corrected.name, "postures": [_json(row) for row in rows]})
        return
    table = Table(title=f"FRFs in MuJoCo beside the measured ones, to {rows[0].top_hz:.0f} Hz")
    for column in ("posture", "", "plain arm off", "corrected arm off"):
        table.add_column(column, justify="right")
    for row in rows:
        table.add_row(
            row.posture,
            "validation" if row.validation else "",
            f"{100 * row.error_before:.1f} %",
            f"{100 * row.error_after:.1f} %",
        )
    out.print(table)
    if html is not None:
        out.print(f"page {html}")
    say_next("export ARM --mjcf OUT --from YOURS", "writes the corrected model")


def _wanted(
    session: Path | None, arm: str | None, simulator: str | None, model: Path | None
) -> tuple[Path, Path, Arm]:
    """Return session, MJCF and corrected arm.

    Raises
    ------
    SessionError, ArmError
        If one is missing; all that are missing are named.
    """
    if simulator != "mujoco" or model is None or session is None or arm is None:
        missing = [
            name
            for name, value in (
                ("a session", session),
                ("--simulator mujoco", simulator if simulator == "mujoco" else None),
                ("--model with your MJCF", model),
                ("--arm with the corrected arm file", arm),
            )
            if value is None
        ]
        got = "none" if simulator in (None, "mujoco") else f"--simulator {simulator}"
        raise SessionError(
            f"wanted {' and '.join(missing)} for the gap in a simulator, got {got}; such as "
            "`armodal gap demo/demo.h5 --arm demo/demo.arm.toml --simulator mujoco --model "
            "robot.xml`"
        )
    corrected = load_arm(arm)
    if not corrected.effects:
        raise ArmError(f"{arm}: wanted a corrected arm file, got one without [[effects]]")
    return session, model, corrected


def _json(row: PostureComparison) -> dict[str, object]:
    return {
        "posture": row.posture,
        "validation": row.validation,
        "top_hz": row.top_hz,
        "error_before": row.error_before,
        "error_after": row.error_after,
    }


def _page(name: str, rows: tuple[PostureComparison, ...]) -> str:
    """The response that moves most in each posture."""
    pictures = []
    for number, row in enumerate(rows):
        size = np.linalg.norm(row.measured.values[:, 0], axis=-1)
        dof = row.measured.responses[int(np.argmax(size))]
        figure = go.Figure()
        for label, frf in (
            ("measured", row.measured),
            ("plain arm", row.before),
            ("corrected arm", row.after),
        ):
            same = [(d.point, d.label) == (dof.point, dof.label) for d in frf.responses]
            at = np.flatnonzero(same)
            keep = frf.freq_hz < row.top_hz
            if at.size:
                figure.add_scatter(
                    x=frf.freq_hz[keep], y=np.abs(frf.values[at[0], 0, keep]), name=label
                )
        figure.update_xaxes(title="Hz")
        figure.update_yaxes(title="m/(N s²)", type="log")
        figure.update_layout(title=f"{row.posture}: point {dof.point} {dof.label}")
        pictures.append(figure.to_html(full_html=False, include_plotlyjs=number == 0))
    return under_policy(
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(name)}: simulator</title></head>\n"
        f'<body style="font-family:sans-serif;max-width:70rem;margin:auto">'
        f"{''.join(pictures)}</body></html>\n"
    )
