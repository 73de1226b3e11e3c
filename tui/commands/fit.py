"""`armodal fit`: modes in every posture of a session."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from rich.table import Table

from armodal.protocols.frf_records import FrfEstimator
from armodal.protocols.session.hdf5 import read_session
from armodal.tui.command_parts.fit_settings import FitSettings
from armodal.tui.command_parts.fit_values import fit_values
from armodal.tui.command_parts.options import Band, SessionPath
from armodal.tui.command_parts.posture_notes import noted_once
from armodal.tui.console import Json, out, print_json, print_note, say_next
from armodal.tui.deviation import deviation

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command()
def fit(
    session: SessionPath,
    band: Band = None,
    estimator: Annotated[
        FrfEstimator | None,
        typer.Option(help="FRF estimator, by where the noise is; by default the plan's."),
    ] = None,
    exponential_end: Annotated[
        float | None, typer.Option(help="Exponential window's value at the record's end; 1: none.")
    ] = None,
    force_window: Annotated[
        float | None, typer.Option(help="Length of the force record kept after the trigger, s.")
    ] = None,
    keep_hits: Annotated[
        int | None, typer.Option(min=1, help="Maximum number of hits averaged at a point.")
    ] = None,
    max_order: Annotated[
        int, typer.Option(min=4, max=300, help="Highest model order of the stabilisation diagram.")
    ] = 60,
    as_json: Json = False,
) -> None:
    """Fit modes in every posture of a session.

    Example: armodal fit session.h5 --band 3 400 --estimator hv --json
    """
    settings = FitSettings(
        band_hz=band,
        estimator=estimator,
        exponential_end=exponential_end,
        force_s=force_window,
        keep_hits=keep_hits,
        max_order=max_order,
    )
    value = fit_values(read_session(session), settings)
    if as_json:
        print_json(value)
        return
    out.print(_table(value))
    for line in _lines(value):
        out.print(line)
    for note in noted_once(value["warnings"]):
        print_note(note)
    say_next(f"review {session}")


def _lines(value: dict[str, Any]) -> list[str]:
    """What a person wants to know beside the table."""
    windows = {made["window"] for made in value["postures"].values()}
    lines = [f"all postures: {window}" for window in windows if len(windows) == 1]
    for posture, made in value["postures"].items():
        error = 100.0 * value["synthesis_error"][posture]
        window = f"; {made['window']}" if len(windows) > 1 else ""
        lines.append(f"{posture}: synthesis error {error:.2g} %{window}")
        lines += [
            f"  hit {hit['hit']} left out, {hit['reason']}: {hit['note']}"
            for hit in made["hits_dropped"]
        ]
        lines += [f"  moves: {told['words']}" for told in made["drift"]]
        lines += [
            f"  {_hinted(hint)}: {100.0 * hint['misfit_share']:.2g} % of the FRFs there are not "
            "explained"
            for hint in made["missing_mode_hints"]
        ]
    return lines


def _hinted(hint: dict[str, Any]) -> str:
    if hint["beside_hz"] is not None:
        return f"the mode at {hint['beside_hz']:.5g} Hz fits worse than the rest"
    return f"a mode may be missing near {hint['f_hz']:.5g} Hz"


def _table(value: dict[str, Any]) -> Table:
    table = Table(title="Modes")
    for column in ("posture", "f Hz", "±", "damping\n%", "±", "MPC", "joint\nshare", ""):
        table.add_column(column, justify="right", no_wrap=True)
    for mode in value["modes"]:
        share = mode["joint_share"]
        table.add_row(
            mode["posture"],
            f"{mode['f_hz']:.3f}",
            deviation(mode["f_std_hz"]),
            f"{100 * mode['damping_ratio']:.3g}",
            f"{100 * mode['damping_std']:.2g}",
            f"{mode['mpc']:.3f}",
            "-" if share is None else f"{share:.2f}",
            "structural" if mode["structural"] else "",
        )
    return table
