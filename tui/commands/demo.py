"""`armodal demo`: a whole test in the simulated laboratory."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from armodal import SOFTWARE
from armodal.tui.command_parts.demo_run import DEMO_TIME_SCALE, run_demo
from armodal.tui.command_parts.demo_simulator import simulator_lines, simulator_table
from armodal.tui.command_parts.gap_results import gap_tables
from armodal.tui.command_parts.identification_results import identification_tables
from armodal.tui.commands.acquire import show_event
from armodal.tui.console import Json, TimeScale, err, out, print_json, say, say_next
from armodal.tui.hit_count import HitCount

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command()
def demo(
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random numbers.")] = 1,
    directory: Annotated[Path, typer.Option("--out", help="Folder for the results.")] = Path(
        "demo"
    ),
    time_scale: TimeScale = DEMO_TIME_SCALE,
    verbose: Annotated[bool, typer.Option("--verbose", help="Print one line per hit.")] = False,
    as_json: Json = False,
) -> None:
    """A whole test in the simulated laboratory: capture, modes, stiffness, gap, report, truth.

    Example: armodal demo --seed 3 --json
    """
    found, result, gap = run_demo(
        directory,
        seed=seed,
        software=SOFTWARE,
        show=show_event if verbose else HitCount(err),
        say=say,
        time_scale=time_scale,
    )
    if as_json:
        print_json(found)
        return
    for table in identification_tables(result):
        out.print(table)
    out.print(_truth_table(found))
    hits = found["hits"]
    out.print(
        f"{hits['accepted']} hits accepted, {hits['rejected']} rejected; "
        f"{found['wall_s']:.0f} s in all, {found['capture_s']:.0f} s of them capture"
    )
    out.print(f"session {found['session']}\nreport  {found['report']}")
    out.print(f"\n{gap.summary}")
    for part in gap_tables(gap):
        out.print(part)
    for effect in found["gap"]["effects"]:
        if "truth_k_n_m_per_rad" in effect:
            k, truth = effect["k_n_m_per_rad"], effect["truth_k_n_m_per_rad"]
            out.print(f"its stiffness {k:.0f} N m/rad, in truth {truth:.0f} N m/rad")
    out.print(f"{found['gap_s']:.0f} s; new arm file {found['gap']['arm_file']}")
    if "simulator" in found:
        if "modes" in found["simulator"]:
            out.print(simulator_table(found["simulator"]))
        for line in simulator_lines(found["simulator"]):
            out.print(line)
    say_next(f"review {found['session']}")


def _truth_table(found: dict[str, Any]) -> Table:
    table = Table(title="Found values against the true ones (N m/rad)")
    for column in ("what", "found", "± 1 std", "truth", "error %", "error / std"):
        table.add_column(column, justify="right")
    rows = [(row["joint"], row) for row in found["joints"]]
    rows += [(f"axis in {row['link']}", row) for row in found["structural"]]
    for name, row in rows:
        truth = row.get("truth_k_n_m_per_rad")
        if truth is None:
            table.add_row(
                name, f"{row['k_n_m_per_rad']:.0f}", f"{row['k_std']:.0f}", "none", "", ""
            )
            continue
        error = row["k_n_m_per_rad"] - truth
        table.add_row(
            name,
            f"{row['k_n_m_per_rad']:.0f}",
            f"{row['k_std']:.0f}",
            f"{truth:.0f}",
            f"{100 * error / truth:+.2f}",
            f"{error / row['k_std']:+.1f}",
        )
    for row in found["structural"]:
        if "axis_angle_error_deg" in row:
            table.caption = (
                f"axis direction off by {row['axis_angle_error_deg']:.2f} deg, "
                f"position by {row['axis_distance_error_mm']:.1f} mm"
            )
    return table
