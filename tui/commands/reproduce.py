"""`armodal reproduce`: published figures of three papers and a later data set, beside ours."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import asdict
from typing import Annotated, Any

import typer
from rich import box
from rich.table import Table
from rich.text import Text

from armodal.analyzer.calibration.calibrate import Calibration
from armodal.analyzer.calibration.from_file import calibrate_from_file
from armodal.analyzer.reproduce.fanuc_2026 import figures_fanuc
from armodal.analyzer.reproduce.file_000 import figures_000
from armodal.analyzer.reproduce.file_001 import figures_001, own_inertias
from armodal.analyzer.reproduce.file_002 import figures_002
from armodal.analyzer.reproduce.records import Figure, FittedModel, Status
from armodal.protocols.arm.files import ARMS_DIRECTORY, load_arm
from armodal.protocols.inertia_targets import load_inertia_targets
from armodal.tui.console import Json, out, print_json, say, say_next

__all__ = ["app"]

app = typer.Typer(add_completion=False)

TARGETS = ARMS_DIRECTORY.parent / "targets"
# The papers, by their numbers in --json.
PAPERS = {
    "000": "A modal approach for the identification of joint and link compliance of an industrial "
    "manipulator",
    "001": "Analysis of the compliance properties of an industrial robot with the Mozzi axis "
    "approach (2019)",
    "002": "Modeling and identification of an industrial robot with a selective modal approach "
    "(2020)",
    "003": "Stiffness-inertia dynamic synergy for breakthrough surge suppression in high-speed "
    "robotic drilling (2026), its published data",
}
STYLES = {Status.DIFFERS: "red", Status.ERRATUM: "yellow", Status.NOT_DERIVABLE: "dim"}


def reproduce_papers(
    n_postures: int, tell: Callable[[str], None]
) -> tuple[list[Figure], list[FittedModel]]:
    """Compute every figure of the papers, and tell what the arms were fitted to."""
    calibrated, predicting = load_arm("viper_s650"), load_arm("viper_s650-without-table4")
    bare = load_arm(TARGETS / "viper_s650-uncalibrated.toml")
    targets = load_inertia_targets(TARGETS / "viper_s650-without-table4.toml", bare)
    tell("paper 000: three joints and a structural compliance of the RV-4FRL")
    figures = [*figures_000(load_arm("rv4frl"))]
    tell("paper 001: three joints of the Viper and its Mozzi axis")
    own = own_inertias(bare, targets)
    figures += figures_001(predicting, own)
    tell("the Viper's inertias from the figures of paper 002")
    calibration = calibrate_from_file(bare, targets)
    tell(f"paper 002: five joints of the Viper, {n_postures} postures")
    figures += figures_002(calibrated, predicting, calibration, n_postures=n_postures)
    tell("data set 003: a drilling FANUC R-2000iC")
    figures += figures_fanuc(load_arm(TARGETS / "fanuc_r2000ic.toml"))
    more = load_inertia_targets(TARGETS / "viper_s650-with-table4.toml", bare)
    n_more = sum(len(modes.f_hz) + len(modes.damping_percent) for modes in more.modes)
    met = _n_figures(calibration)
    with_priors = "numbers of the links' inertias, each with a prior, fitted to the total mass"
    models = [
        FittedModel(
            arm="rv4frl",
            parameters=1,
            figures=3,
            words="one density of all links, fitted to the three inertias of paper 000, Table 4",
        ),
        FittedModel(
            arm="viper_s650-without-table4",
            parameters=calibration.u.size,
            figures=met,
            words=f"{with_priors}, five inertias and two zeros of paper 002",
        ),
        FittedModel(
            arm="viper_s650",
            parameters=calibration.u.size,
            figures=met + n_more,
            words="the same, fitted to paper 002's Table 4 as well",
        ),
        FittedModel(
            arm="viper_s650 by paper 001",
            parameters=own.u.size,
            figures=_n_figures(own),
            words=f"{with_priors} and the three inertias of paper 001, Table 2",
        ),
    ]
    return figures, models


def _n_figures(calibration: Calibration) -> int:
    return sum(pull.size for _, pull in calibration.pulls)


def figure_json(figure: Figure) -> dict[str, Any]:
    """One figure as plain values."""
    return {
        "paper": figure.paper,
        "table": figure.table,
        "item": figure.item,
        "unit": figure.unit,
        "published": figure.published,
        "ours": figure.ours,
        "ours_std": figure.ours_std,
        "margin": figure.margin,
        "status": figure.status.value,
        "why": figure.why,
    }


def figure_tables(figures: list[Figure]) -> list[Table | Text]:
    """One table a paper with its reasons beneath, and how many figures have which status."""
    shown: list[Table | Text] = []
    for paper in sorted({figure.paper for figure in figures}):
        table = Table(
            title=f"Paper {paper}: {PAPERS[paper]}", box=box.SIMPLE, padding=0, expand=True
        )
        table.add_column("figure", ratio=1)
        for column in ("published", "ours", "margin"):
            table.add_column(column, justify="right", no_wrap=True)
        table.add_column("status", no_wrap=True)
        notes = Text()
        for figure in figures:
            if figure.paper != paper:
                continue
            unit = f", {figure.unit}" if figure.unit not in {"", "yes/no"} else ""
            table.add_row(
                f"{figure.table}: {figure.item}{unit}",
                _shown(figure.published),
                _shown(figure.ours)
                + ("" if figure.ours_std is None else f" ± {figure.ours_std:.2g}"),
                "" if figure.margin is None else f"{figure.margin:.3g}",
                figure.status.value,
                style=STYLES.get(figure.status),
            )
            if figure.margin is None or figure.status is Status.DIFFERS:
                notes.append(f"{figure.table}: {figure.item}: {figure.why}\n", style="dim")
        shown += [table, notes]
    counts = Table(title="All figures", box=box.SIMPLE)
    counts.add_column("status")
    counts.add_column("number", justify="right")
    for status, number in Counter(figure.status for figure in figures).most_common():
        counts.add_row(status.value, str(number))
    return [*shown, counts]


def _shown(value: float | bool | str | None) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return value if isinstance(value, str) else f"{value:.6g}"


@app.command("reproduce")
def reproduce_command(
    postures: Annotated[
        int, typer.Option(min=1000, max=100_000_000, help="Random postures of paper 002's study.")
    ] = 1_000_000,
    as_json: Json = False,
) -> None:
    """Compare published figures of three papers and a later data set with armodal's own.

    Example: armodal reproduce --json
    """
    figures, models = reproduce_papers(postures, say)
    if as_json:
        rows: list[dict[str, Any]] = [figure_json(figure) for figure in figures]
        print_json({"figures": rows, "models": [asdict(model) for model in models]})
        return
    for table in figure_tables(figures):
        out.print(table)
    for model in models:
        out.print(
            f"{model.arm}: {model.parameters} parameter(s) fitted to {model.figures} figures: "
            f"{model.words}"
        )
    say_next("demo", "a whole test of an arm in the simulated laboratory")
