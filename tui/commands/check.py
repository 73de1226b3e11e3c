"""`armodal check`: does a device keep to its protocol? Step by step, and what to do where not."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table
from rich.text import Text

from armodal.daq.check import BoardCheckOptions, Report, StepResult, Verdict, check_board, check_can
from armodal.daq.clock import SystemClock
from armodal.daq.serial_port import SerialPort
from armodal.protocols.arm.files import load_arm
from armodal.protocols.session.hdf5 import read_session
from armodal.tui.command_parts.check_session import session_checks
from armodal.tui.console import Json, TimeScale, err, out, print_json, say, say_next
from armodal.tui.this_system import check_runs_devices

__all__ = ["app"]

FAILED = 1
STYLES = {Verdict.PASS: "green", Verdict.FAIL: "red", Verdict.NOT_CHECKED: "yellow"}

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    help="Check a board, a controller or a measurement: what was wanted, what came.\n\n"
    "Example: armodal check board /dev/ttyACM0",
)

Duration = Annotated[
    float,
    typer.Option(
        min=0.1, help="Length of the long run, s; extended to 60 until the clock's rate is known."
    ),
]
Only = Annotated[list[str] | None, typer.Option("--step", help="Only this step; repeatable.")]


@app.command("board")
def check_board_command(
    port: Annotated[str, typer.Argument(help="Serial port of the board.")],
    duration: Duration = 60.0,
    rate: Annotated[
        str | None, typer.Option(help="Sample rate of the runs in Hz, as 12800 or 51200/31.")
    ] = None,
    baud: Annotated[int, typer.Option(min=1, help="Bit rate of a UART.")] = 921_600,
    time_scale: TimeScale = 1.0,
    step: Only = None,
    as_json: Json = False,
) -> None:
    """Check a board against the board protocol; exit code 1 if a step fails.

    Example: armodal check board /dev/ttyACM0 --duration 60
    """
    check_runs_devices("check board")
    options = BoardCheckOptions(duration_s=duration, rate_hz=_rate(rate))
    report = check_board(
        lambda: SerialPort(port, baud=baud),
        options,
        clock=SystemClock(scale=time_scale),
        only=step or (),
        tell=_tell,
    )
    _finish(report, "board", port, as_json=as_json)


@app.command("can")
def check_can_command(
    channel: Annotated[str, typer.Argument(help="slcan port, or interface:channel.")],
    arm: Annotated[str, typer.Option(help="Arm file or shipped arm.")] = "rv4frl",
    duration: Annotated[float, typer.Option(min=0.1, help="How long to listen, s.")] = 10.0,
    time_scale: TimeScale = 1.0,
    step: Only = None,
    as_json: Json = False,
) -> None:
    """Check a controller's CAN frames by listening only; exit code 1 if a step fails.

    Example: armodal check can /dev/ttyACM1 --arm rv4frl
    """
    check_runs_devices("check can")
    report = check_can(
        channel,
        load_arm(arm),
        duration_s=duration,
        clock=SystemClock(scale=time_scale),
        only=step or (),
        tell=_tell,
    )
    _finish(report, "can", channel, as_json=as_json)


@app.command("session")
def check_session_command(
    session: Annotated[Path, typer.Argument(help="Session file (.h5).")],
    as_json: Json = False,
) -> None:
    """Check a measurement without a model: sensor faults, reciprocity, homogeneity, drift.

    Exit code 1 if a fault is found.

    Example: armodal check session session.h5
    """
    value, table = session_checks(read_session(session))
    if as_json:
        print_json(value)
    else:
        out.print(table)
    faulty = any(row["fault"] for row in value["checks"])
    if not as_json:
        say_next(f"review {session}" if faulty else f"fit {session}")
    if faulty:
        raise typer.Exit(FAILED)


def _rate(text: str | None) -> Fraction | None:
    if text is None:
        return None
    try:
        rate_hz = Fraction(text)
    except (ValueError, ZeroDivisionError):
        rate_hz = Fraction(0)
    if rate_hz <= 0 or max(rate_hz.numerator, rate_hz.denominator) >= 1 << 32:
        raise typer.BadParameter(f"wanted a rate in Hz such as 12800 or 51200/31, got {text!r}")
    return rate_hz


def _tell(news: StepResult | str) -> None:
    if isinstance(news, str):
        say(news)
    elif news.verdict is not Verdict.PASS:
        err.print(f"  {news.verdict}: {news.came}")


def _finish(report: Report, kind: str, port: str, *, as_json: bool) -> None:
    if as_json:
        print_json(report.as_json())
    else:
        out.print(_table(report))
        for step in report.steps:
            if step.hint:
                out.print(f"{step.title}: {step.hint}")
        counts = ", ".join(f"{report.count(verdict)} {verdict}" for verdict in Verdict)
        out.print(f"{report.device}: {counts}")
        passed = (f"run PLAN --{kind} {port}", "")
        failed = (f"check {kind} {port}", "once the faults above are mended")
        say_next(*(passed if report.passed else failed))
    if not report.passed:
        raise typer.Exit(FAILED)


def _table(report: Report) -> Table:
    table = Table(show_lines=True)
    for column in ("step", "wanted", "came", "verdict"):
        table.add_column(column, no_wrap=column == "verdict")
    for step in report.steps:
        style = STYLES[step.verdict]
        table.add_row(
            step.title,
            step.wanted,
            step.came,
            Text(step.verdict.value, style=style),
        )
    return table
