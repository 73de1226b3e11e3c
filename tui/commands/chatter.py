"""`armodal chatter`: how deep the arm can mill before it chatters."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import plotly.graph_objects as go
import typer
from rich.table import Table

from armodal.analyzer.acting.chatter import LobeDiagram, depth_map, lobe_diagram, tool_frame
from armodal.analyzer.acting.cutting import Cutter
from armodal.analyzer.arm.wanted_posture import wanted_posture
from armodal.analyzer.corrected.correction import correction_of
from armodal.analyzer.report.policy import under_policy
from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmError
from armodal.protocols.text_file import replace_text
from armodal.tui.command_parts.options import ArmName, comma_numbers
from armodal.tui.commands.shaper import PathOption, PostureOption, asked_postures
from armodal.tui.console import Json, out, print_json, print_note
from armodal.tui.output_file import check_output

__all__ = ["app"]

app = typer.Typer(add_completion=False)

_SHOWN = 12  # speeds of the table
_NOTE = (
    "the work is taken as rigid, and a spindle's own modes are not in the arm's model: they may "
    "limit the cut at high speeds"
)


@app.command("chatter")
def chatter_command(
    arm: ArmName,
    kt: Annotated[float, typer.Option(help="Tangential cutting coefficient, N/mm².")],
    posture: PostureOption = None,
    path: PathOption = None,
    kr: Annotated[float, typer.Option(help="Radial cutting coefficient, N/mm².")] = 0.0,
    teeth: Annotated[int, typer.Option(min=1, max=100, help="Teeth of the cutter.")] = 2,
    immersion: Annotated[float, typer.Option(help="Radial depth over the diameter.")] = 1.0,
    down: Annotated[bool, typer.Option("--down/--up", help="Down- or up-milling.")] = True,
    speeds: Annotated[
        str, typer.Option(help="low,high,number of spindle speeds, rpm.")
    ] = "500,20000,200",
    feed: Annotated[str, typer.Option(help="x,y,z of the feed, base axes.")] = "1,0,0",
    axis: Annotated[str, typer.Option(help="x,y,z of the tool's axis, base axes.")] = "0,0,1",
    at: Annotated[
        str, typer.Option(help="Tool point x,y,z in the last link's frame, m.")
    ] = "0,0,0",
    directions: Annotated[
        int, typer.Option(min=1, max=360, help="With several postures: number of feed directions.")
    ] = 12,
    html: Annotated[Path | None, typer.Option(help="Page with the lobes to write.")] = None,
    as_json: Json = False,
) -> None:
    """Stability lobes at the tool with a 95 % band; for postures, a map over feed directions.

    Example: armodal chatter demo/demo.arm.toml --posture=0,30,60,0,60,0 --kt 600 --kr 200
    """
    the_arm = load_arm(arm)
    asked = asked_postures(the_arm, posture, path)
    q = np.array([wanted_posture(the_arm, angles) for angles in asked])
    cutter = Cutter(
        teeth=teeth,
        tangential_n_per_m2=1e6 * kt,
        radial_n_per_m2=1e6 * kr,
        immersion=immersion,
        down=down,
    )
    tool, spindle = comma_numbers(at, "--at", 3), comma_numbers(axis, "--axis", 3)
    if html is not None:
        check_output(html, *([path] if path is not None else []))
    correction = correction_of(the_arm)
    notes = [_NOTE, *correction.notes]
    if len(q) > 1:
        if html is not None:
            raise ArmError("--html: wanted one posture, of which lobes are drawn, got several")
        feeds, depths = depth_map(
            correction, q, cutter, axis=spindle, tool_m=tool, n_directions=directions
        )
        _map(the_arm.name, asked, feeds, depths, notes, as_json=as_json)
        return
    found = lobe_diagram(
        correction,
        q[0],
        cutter,
        _speeds(speeds),
        directions=tool_frame(comma_numbers(feed, "--feed", 3), spindle),
        tool_m=tool,
    )
    if html is not None:
        replace_text(html, _page(the_arm.name, found))
    if as_json:
        print_json(_json(the_arm.name, asked[0], found, notes))
        return
    for table in _tables(found):
        out.print(table)
    out.print(
        f"stable at any speed: {_mm(found.always_m)} mm, with 97.5 % certainty "
        f"{_mm(found.always_low_m)} mm"
    )
    for note in notes:
        print_note(note)
    if html is not None:
        out.print(f"page {html}")
    out.print("next: armodal stiffness-map for a stiffer posture, or --path for a map over feeds")


def _speeds(text: str) -> Any:
    low, high, count = comma_numbers(text, "--speeds", 3)
    if not 0.0 < low < high or not 2 <= count <= 2000 or count != int(count):
        raise ArmError(
            f"--speeds: wanted low below high, both positive, and 2 to 2000 of them, got {text!r}"
        )
    return np.linspace(low, high, int(count))


def _mm(depth_m: float) -> str:
    return "no limit" if not np.isfinite(depth_m) else f"{1e3 * depth_m:.3f}"


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _json(name: str, posture: list[float], found: LobeDiagram, notes: list[str]) -> dict[str, Any]:
    return {
        "arm": name,
        "posture_deg": posture,
        "speeds_rpm": found.speeds_rpm.tolist(),
        "depth_m": [_number(v) for v in found.depth_m],
        "depth_low_m": [_number(v) for v in found.low_m],
        "depth_high_m": [_number(v) for v in found.high_m],
        "always_m": _number(found.always_m),
        "always_low_m": _number(found.always_low_m),
        "semi_discretisation": [
            {"speed_rpm": float(n), "depth_m": float(d)}
            for n, d in zip(found.checked_rpm, found.checked_m, strict=True)
        ],
        "notes": notes,
    }


def _tables(found: LobeDiagram) -> list[Table]:
    table = Table(title="Deepest stable cut (95 % band)", title_justify="left")
    for column in ("rpm", "mm", "from", "to"):
        table.add_column(column, justify="right")
    for i in np.linspace(0, len(found.speeds_rpm) - 1, _SHOWN).astype(int):
        values = (found.depth_m[i], found.low_m[i], found.high_m[i])
        table.add_row(f"{found.speeds_rpm[i]:.0f}", *(_mm(v) for v in values))
    check = Table(title="By the delayed equations", title_justify="left")
    for column in ("rpm", "mm"):
        check.add_column(column, justify="right")
    for n, d in zip(found.checked_rpm, found.checked_m, strict=True):
        check.add_row(f"{n:.0f}", _mm(d))
    return [table, check]


def _map(
    name: str,
    asked: list[list[float]],
    feeds: Any,
    depths: Any,
    notes: list[str],
    *,
    as_json: bool,
) -> None:
    if as_json:
        print_json(
            {
                "arm": name,
                "postures_deg": asked,
                "feeds": feeds.tolist(),
                "always_m": [[_number(v) for v in row] for row in depths],
                "notes": notes,
            }
        )
        return
    table = Table(title="Cut that is stable at any speed, mm", title_justify="left")
    for column in ("posture", "best feed", "mm", "worst feed", "mm"):
        table.add_column(column, justify="right")
    for angles, row in zip(asked, depths, strict=True):
        best, worst = int(np.argmax(row)), int(np.argmin(row))
        words = [
            part
            for i in (best, worst)
            for part in (" ".join(f"{v:+.2f}" for v in feeds[i]), _mm(row[i]))
        ]
        table.add_row(" ".join(f"{a:g}" for a in angles), *words)
    out.print(table)
    for note in notes:
        print_note(note)
    out.print("next: one posture alone with --feed gives its lobes")


def _page(name: str, found: LobeDiagram) -> str:
    figure = go.Figure()
    for values, label, dash in (
        (found.high_m, "97.5 %", "dot"),
        (found.low_m, "2.5 %", "dot"),
        (found.depth_m, "arm file", "solid"),
    ):
        shown = np.where(np.isfinite(values), 1e3 * values, np.nan)
        figure.add_scatter(x=found.speeds_rpm, y=shown, name=label, line={"dash": dash})
    figure.add_scatter(
        x=found.checked_rpm,
        y=1e3 * found.checked_m,
        mode="markers",
        name="delayed equations",
    )
    top = 1e3 * float(np.nanquantile(found.depth_m[np.isfinite(found.depth_m)], 0.9))
    figure.update_xaxes(title="spindle speed, rpm")
    figure.update_yaxes(title="axial depth, mm", range=[0.0, 1.5 * top])
    figure.update_layout(title=f"Stability lobes at the tool of {name}: below is stable")
    return under_policy(
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(name)}: chatter</title></head>\n"
        f'<body style="font-family:sans-serif;max-width:70rem;margin:auto">'
        f"{figure.to_html(full_html=False)}</body></html>\n"
    )
