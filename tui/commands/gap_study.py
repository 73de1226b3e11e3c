"""`armodal gap-study`: how often the gap workflow is right on sealed cases."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

import armodal.study
from armodal.hil_sim.makers import draw_cases, newest_version
from armodal.hil_sim.study import LIBRARY, OUTSIDE, VERSION, CaseSpec, draw_study, library
from armodal.protocols.errors import PlantError
from armodal.protocols.text_file import replace_text
from armodal.study.cases import HOME, AnySpec, every_maker
from armodal.study.curves import curve_rows, run_curves
from armodal.study.official import official_seed
from armodal.study.page import study_page
from armodal.study.run import run_study, seal_hashes
from armodal.study.summary import study_summary
from armodal.study.tables import study_tables
from armodal.tui.command_parts.options import refuse_idle
from armodal.tui.command_parts.worker_processes import worker_processes
from armodal.tui.console import Json, out, print_json, say, say_next
from armodal.tui.output_file import check_output

__all__ = ["app"]

app = typer.Typer(add_completion=False)

_OF_HOME = ("pairs", "outside", "whole", "curves")  # by parameter: of its cases alone


@app.command("gap-study")
def gap_study_command(
    context: typer.Context,
    directory: Annotated[Path, typer.Option("--out", help="Folder for the study.")],
    seed: Annotated[int, typer.Option(min=0, help="Seed of the cases.")] = 1,
    official: Annotated[
        bool, typer.Option("--official", help="Take the seed from the hash of the commit.")
    ] = False,
    maker: Annotated[
        str, typer.Option(help=f"Who makes the cases: {', '.join(every_maker())}.")
    ] = HOME,
    nulls: Annotated[int, typer.Option(min=0, help="Cases with nothing hidden.")] = 30,
    effects: Annotated[int, typer.Option(min=0, help="Cases with one effect.")] = 60,
    pairs: Annotated[int, typer.Option(min=0, help="Cases with two effects.")] = 12,
    outside: Annotated[int, typer.Option(min=0, help="Cases outside the library.")] = 12,
    tests: Annotated[
        int,
        typer.Option(
            min=0,
            help="Maximum of further tests of a case, or of every fifth one with nothing hidden.",
        ),
    ] = 0,
    whole: Annotated[
        bool, typer.Option("--whole", help="Hide effects of the whole library, hits at 3 levels.")
    ] = False,
    version: Annotated[
        int | None,
        typer.Option(
            "--library",
            min=1,
            max=VERSION,
            help="Version of the library; the newest, but without --whole home's first.",
        ),
    ] = None,
    curves: Annotated[
        int, typer.Option(min=0, help="Clear cases measured again with fewer hits or points.")
    ] = 0,
    page: Annotated[
        Path | None, typer.Option("--page", help="Markdown page of the tables to write.")
    ] = None,
    workers: Annotated[int, typer.Option(min=1, help="Number of processes.")] = 2,
    as_json: Json = False,
) -> None:
    """Run the gap workflow on sealed cases and print how often it was right.

    A study that was stopped continues where it stopped.

    Example: armodal gap-study --out study --seed 1
    """
    if maker != HOME:
        refuse_idle(context, _OF_HOME, here=f"--maker {maker}", there=f"--maker {HOME}")
    if page is not None:
        check_output(page)
    commit = ""
    if official:
        refuse_idle(context, ("seed",), here="--official", there="a study that is not official")
        seed, commit = official_seed(Path(armodal.study.__file__).parent)
        say(f"official: seed {seed} of commit {commit}")
    specs: tuple[AnySpec, ...]
    if maker == HOME:
        version = version or (VERSION if whole else 1)
        specs = draw_study(
            seed,
            nulls=nulls,
            effects=effects,
            pairs=pairs,
            outside=outside,
            library=library(version),
            ladder=whole,
        )
    elif maker not in every_maker():
        raise PlantError(f"no maker is called {maker!r}; wanted one of {', '.join(every_maker())}")
    else:
        version = version or newest_version(maker)
        specs = draw_cases(maker, seed, nulls=nulls, effects=effects, version=version)
    directory.mkdir(parents=True, exist_ok=True)
    path = directory / f"study-{maker}-{seed}.jsonl"

    with worker_processes(workers) as executor:
        hashes = seal_hashes(specs, executor)
        for number, digest in hashes.items():
            say(f"case {number}: truth sealed as {digest}")
        lines = run_study(specs, hashes, path, executor, say, tests=tests)
        own = [s for s in specs if isinstance(s, CaseSpec)]
        clear = [s for s in own if len(s.kinds) == 1 and s.magnitude == "clear"]
        again = [s for s in clear if s.kinds[0] in LIBRARY][:curves]
        learned = (
            run_curves(again, hashes, directory / f"curves-{seed}.jsonl", executor, say)
            if again
            else []
        )
    summary = study_summary(lines)
    rows = curve_rows(learned) if learned else []
    tables = study_tables(summary, rows)
    command = _command(specs, maker, "--official" if official else f"--seed {seed}", tests, curves)
    command += f" --library {version}{' --whole' if whole else ''} --page PAGE"
    if page is not None:
        replace_text(page, study_page(tables, command, commit))
    if as_json:
        print_json(
            summary
            | {"curves": rows, "file": str(path), "maker": maker, "seed": seed, "commit": commit}
        )
        return
    for table in tables:
        drawn = Table(*table.head, title=table.title, caption=table.note or None)
        for row in table.rows:
            drawn.add_row(*row)
        out.print(drawn)
    out.print(f"cases {path}")
    say_next("gap SESSION", "asks the same of your own session")


def _command(specs: Sequence[AnySpec], maker: str, of_seed: str, tests: int, curves: int) -> str:
    """The command that makes a study's page again."""
    outside = (
        [s for s in specs if any(kind in OUTSIDE for kind in s.kinds)] if maker == HOME else []
    )
    counts = {
        "nulls": sum(not s.kinds for s in specs),
        "effects": sum(len(s.kinds) == 1 for s in specs) - len(outside),
        "pairs": sum(len(s.kinds) == 2 for s in specs),
        "outside": len(outside),
        "tests": tests,
        "curves": curves,
    }
    needed = ("nulls", "effects", *(("pairs", "outside") if maker == HOME else ()))
    words = [f"--{name} {n}" for name, n in counts.items() if n or name in needed]
    if maker != HOME:
        words.insert(0, f"--maker {maker}")
    return f"armodal gap-study --out study {of_seed} {' '.join(words)}"
