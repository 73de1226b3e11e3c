"""The `armodal` command."""

from __future__ import annotations

import json
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from analyzer.arm.superset import Superset
from analyzer.identification.identify import estimate_frfs
from daq.events import Event
from daq.settings import AcquisitionSettings
from hil_sim.lab import start_laboratory
from protocols.arm.files import load_arm
from protocols.errors import ArmodalError, SessionError
from protocols.plan import load_plan
from protocols.session.recovery import rebuild
from tui.acquire import Operator, PersonAtTerminal, ScriptedOperator, acquire, describe
from tui.arm_commands import app as arm_app
from tui.check import app as check_app
from tui.check import broken_lines
from tui.console import Json, err, out, print_json, say
from tui.demo import DEMO_TIME_SCALE, run_demo
from tui.exchange import add_exchange_commands
from tui.gap import gap_tables
from tui.gap_commands import app as gap_app
from tui.results import identification_tables
from tui.review.command import add_review_command
from tui.run.command import run_app
from tui.session_commands import app as session_app

__all__ = ["main"]

SOFTWARE = f"armodal {version('armodal')}"
USER_ERROR = 2

app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False)
app.add_typer(check_app, name="check")
app.add_typer(arm_app)
app.add_typer(session_app)
app.add_typer(gap_app)


def _show(event: Event) -> None:
    line = describe(event)
    if line is not None:
        err.print(line, markup=False)


@app.command()
def demo(
    seed: Annotated[int, typer.Option(help="For everything random in the laboratory.")] = 1,
    directory: Annotated[Path, typer.Option("--out", help="Where the results go.")] = Path("demo"),
    time_scale: Annotated[float, typer.Option(help="Lab seconds a second.")] = DEMO_TIME_SCALE,
    as_json: Json = False,
) -> None:
    """A whole test in the simulated laboratory: capture, modes, stiffness, gap, report, truth.

    Example: armodal demo --seed 3 --json
    """
    found, result, gap = run_demo(
        directory, seed=seed, software=SOFTWARE, show=_show, say=say, time_scale=time_scale
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
    out.print(f"session {found['session']}\nreport  {found['report']}", markup=False)
    out.print(f"\n{gap.summary}", markup=False)
    for table in gap_tables(gap):
        out.print(table)
    for effect in found["gap"]["effects"]:
        if "truth_k_n_m_per_rad" in effect:
            k, truth = effect["k_n_m_per_rad"], effect["truth_k_n_m_per_rad"]
            out.print(f"its stiffness {k:.0f} N m/rad, in truth {truth:.0f} N m/rad")
    out.print(f"{found['gap_s']:.0f} s; new arm file {found['gap']['arm_file']}", markup=False)


def _truth_table(found: dict[str, Any]) -> Table:
    table = Table(title="Beside the truth the laboratory kept to itself (N m/rad)")
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


@app.command()
def sim(
    plant: Annotated[str, typer.Option(help="Shipped plant or a plant file.")] = "rv4frl",
    seed: Annotated[int, typer.Option(help="For everything random in it.")] = 1,
    time_scale: Annotated[float, typer.Option(help="Lab seconds a second.")] = 1.0,
    directory: Annotated[Path | None, typer.Option("--out", help="Socket and ledger.")] = None,
    fault: Annotated[list[str] | None, typer.Option(help="A scripted fault; repeatable.")] = None,
    broken_board: Annotated[
        str | None, typer.Option(help="A board that breaks the protocol in one way.")
    ] = None,
    broken_controller: Annotated[
        str | None, typer.Option(help="A controller or bus with one fault.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Start the simulated laboratory, print its ports, run until Ctrl-C.

    Example: armodal sim --time-scale 8
    """
    with (
        start_laboratory(
            plant, seed=seed, time_scale=time_scale, directory=directory, faults=tuple(fault or ())
        ) as laboratory,
        broken_lines(laboratory, board=broken_board, controller=broken_controller) as lines,
    ):
        ports = {
            "board": lines[0],
            "can": lines[1],
            "operator": str(laboratory.operator),
            "ledger": str(laboratory.ledger),
            "time_scale": laboratory.time_scale,
        }
        if as_json:
            sys.stdout.write(json.dumps(ports) + "\n")
            sys.stdout.flush()
        else:
            for name, value in ports.items():
                out.print(f"{name:<11}{value}", markup=False)
        laboratory.wait()


@app.command("acquire")
def acquire_command(
    plan: Annotated[str, typer.Argument(help="Plan file or shipped plan.")],
    board: Annotated[str, typer.Option(help="Serial port of the acquisition board.")],
    can: Annotated[str, typer.Option(help="slcan port, or interface:channel.")],
    arm: Annotated[str, typer.Option(help="Arm file or shipped arm.")] = "rv4frl",
    journal: Annotated[Path, typer.Option(help="Journal to write.")] = Path("session.journal"),
    resume: Annotated[bool, typer.Option(help="Go on with an interrupted journal.")] = False,
    operator: Annotated[Path | None, typer.Option(help="Socket of a scripted operator.")] = None,
    time_scale: Annotated[float, typer.Option(help="Lab seconds a second.")] = 1.0,
    baud: Annotated[int, typer.Option(min=1, help="Bit rate of a UART.")] = 921_600,
    as_json: Json = False,
) -> None:
    """Capture a session: postures, points and hits of a plan, into a durable journal.

    Example: armodal acquire rv4frl-three-postures --board /dev/ttyACM0 --can /dev/ttyACM1
    """
    the_arm = load_arm(arm)
    the_plan = load_plan(plan, the_arm)
    person: Operator = (
        PersonAtTerminal(err.input)
        if operator is None
        else ScriptedOperator(operator, the_arm, the_plan, time_scale=time_scale)
    )
    settings = AcquisitionSettings(
        board_port=board,
        board_baud=baud,
        can_channel=can,
        arm=the_arm,
        plan=the_plan,
        journal=journal,
        resume=resume,
        time_scale=time_scale,
        software=SOFTWARE,
    )
    finished = acquire(settings, person, _show)
    session_path = journal.with_suffix(".h5")
    superset = Superset(the_arm)
    rebuild(
        journal,
        session_path,
        software=SOFTWARE,
        estimate_frfs=lambda session: estimate_frfs(session, superset),
    )
    summary = {
        "session": str(session_path),
        "journal": str(journal),
        "complete": finished.complete,
        "reason": finished.reason,
        "hits": {"accepted": finished.accepted, "rejected": finished.rejected},
    }
    if as_json:
        print_json(summary)
    else:
        out.print(
            f"{finished.accepted} hits accepted, {finished.rejected} rejected: "
            f"{finished.reason}\nsession {session_path}",
            markup=False,
        )


@app.command("run")
def run_command(
    plan: Annotated[str | None, typer.Argument(help="Plan file or shipped plan.")] = None,
    simulated: Annotated[bool, typer.Option("--sim", help="In the simulated laboratory.")] = False,
    session: Annotated[
        Path, typer.Option(help="Journal to begin, or to go on with if it is there.")
    ] = Path("session.journal"),
    board: Annotated[str, typer.Option(help="Serial port of the acquisition board.")] = "",
    can: Annotated[str, typer.Option(help="slcan port, or interface:channel.")] = "",
    arm: Annotated[str, typer.Option(help="Arm file or shipped arm.")] = "rv4frl",
    baud: Annotated[int, typer.Option(min=1, help="Bit rate of a UART.")] = 921_600,
    input_range: Annotated[
        float | None,
        typer.Option(help="Largest input voltage of the board; with it sensitivities show in mV."),
    ] = None,
    time_scale: Annotated[float, typer.Option(help="Lab seconds a second.")] = 1.0,
    seed: Annotated[int, typer.Option(help="For everything random in the simulation.")] = 1,
) -> None:
    """Guide the operator through a session, on screens that read from two metres.

    Example: armodal run --sim
    """
    raise typer.Exit(
        run_app(
            plan=plan,
            arm=arm,
            session=session,
            board=board,
            can=can,
            baud=baud,
            simulated=simulated,
            input_range_v=input_range,
            seed=seed,
            time_scale=time_scale,
            software=SOFTWARE,
        )
    )


@app.command()
def recover(
    journal: Annotated[Path, typer.Argument(help="Journal of an interrupted session.")],
    output: Annotated[Path | None, typer.Option("--out", help="Session file to write.")] = None,
    as_json: Json = False,
) -> None:
    """Rebuild the session file from a journal, and say what was recovered and dropped.

    Example: armodal recover session.journal
    """
    path = output or journal.with_suffix(".h5")
    found = rebuild(
        journal,
        path,
        software=SOFTWARE,
        estimate_frfs=lambda session: estimate_frfs(session, Superset(session.header.arm)),
    )
    summary = {
        "session": str(path),
        "hits": {"accepted": found.accepted, "rejected": found.rejected},
        "recovered_bytes": found.recovered_bytes,
        "dropped_bytes": found.dropped_bytes,
        "complete": found.session.complete,
        "warnings": list(found.session.warnings),
        "frf_problem": found.frf_problem,
    }
    if as_json:
        print_json(summary)
        return
    for name, value in summary.items():
        out.print(f"{name:<16}{value}", markup=False)


add_exchange_commands(app, software=SOFTWARE, out=out, say=say)
add_review_command(app, software=SOFTWARE)


def main() -> None:
    """Run the command line: a user's mistake is one message and exit code 2."""
    try:
        app(standalone_mode=True)
    except ArmodalError as error:
        err.print(f"armodal: {error}", markup=False)
        sys.exit(USER_ERROR)
    except OSError as error:
        problem = SessionError(f"{error.filename or 'file'}: {error.strerror or error}")
        err.print(f"armodal: {problem}", markup=False)
        sys.exit(USER_ERROR)
    except KeyboardInterrupt:
        err.print("armodal: stopped", markup=False)
        sys.exit(130)


if __name__ == "__main__":
    main()
