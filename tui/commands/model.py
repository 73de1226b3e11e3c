"""`armodal model diff` and `armodal model check`: books of an arm file."""

from __future__ import annotations

from dataclasses import asdict
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from armodal.analyzer.corrected.check import CheckedPosture, check_posture_rows, known_sessions
from armodal.analyzer.corrected.diff import Change, arm_changes
from armodal.protocols.arm.files import load_arm
from armodal.protocols.session.hdf5 import read_session
from armodal.tui.command_parts.options import ArmName
from armodal.tui.console import Json, out, print_json

__all__ = ["app"]

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    help="Compare arm files, and see which sessions one is based on.\n\n"
    "Example: armodal model diff rv4frl demo/demo.arm.toml",
)


@app.command("diff")
def diff_command(
    before: ArmName,
    after: Annotated[str, typer.Argument(help="Arm file to compare with it.")],
    as_json: Json = False,
) -> None:
    """Compare two arm files, in words and numbers.

    Example: armodal model diff rv4frl demo/demo.arm.toml
    """
    changes = arm_changes(load_arm(before), load_arm(after))
    if as_json:
        print_json({"before": before, "after": after, "changes": [asdict(c) for c in changes]})
        return
    for change in changes:
        if change.words:
            out.print(change.words)
    numbers = [change for change in changes if not change.words]
    if numbers:
        table = Table("what", "before", "after", "", "unit", title="Numbers")
        for change in numbers:
            table.add_row(change.what, *_cells(change), change.unit)
        out.print(table)
    if not changes:
        out.print("nothing changed")
    out.print("next: armodal model check with the sessions that were measured")


def _cells(change: Change) -> tuple[str, str, str]:
    a, b = change.before, change.after
    ratio = f"{100 * (b / a - 1.0):+.2f} %" if a and b is not None else ""
    return "" if a is None else f"{a:.6g}", "" if b is None else f"{b:.6g}", ratio


@app.command("check")
def check_command(
    arm: ArmName,
    sessions: Annotated[
        list[Path] | None, typer.Argument(help="Sessions (.h5) of the arm to compare with.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Which sessions an arm file is based on, how old they are, and how well it predicts others.

    Example: armodal model check demo/demo.arm.toml demo/demo.h5
    """
    the_arm = load_arm(arm)
    read = {path: read_session(path) for path in sessions or ()}
    digests = {path: sha256(path.read_bytes()).hexdigest() for path in read}
    known = known_sessions(the_arm, set(digests.values()), datetime.now(UTC))
    own = {row.session_sha256 for row in known}
    rows: dict[str, tuple[CheckedPosture, ...]] = {
        str(path): check_posture_rows(the_arm, read[path], known=digest in own)
        for path, digest in digests.items()
    }
    if as_json:
        print_json(
            {
                "arm": the_arm.name,
                "known": [asdict(row) for row in known],
                "sessions": {path: [asdict(row) for row in of] for path, of in rows.items()},
            }
        )
        return
    _print_known(known)
    for path, of in rows.items():
        out.print(_posture_table(path, of))
    if not rows:
        out.print("next: give sessions of the arm, to set its modes beside those measured")
        return
    unseen = [row for of in rows.values() for row in of if not row.known]
    if not unseen:
        out.print(
            "next: measure postures of a new session; `armodal gap` has fitted to all of these"
        )
        return
    worst = max((row.f_error for row in unseen if row.f_error is not None), default=None)
    if worst is None:
        out.print(
            "next: check the stiffnesses in the arm file; none of its modes is as low as those "
            "that were measured"
        )
        return
    out.print(
        f"postures it was not fitted to: frequencies within {100 * worst:.2f} %; next: "
        "`armodal gap --arm` with a session where that is too much"
    )


def _print_known(known: Any) -> None:
    if not known:
        out.print("no session is behind this arm file: all its values are assumed")
        return
    table = Table("session", "by", "days ago", "given", title="What it stands on")
    for row in known:
        table.add_row(
            row.session_sha256[:12], row.by, f"{row.days:.1f}", "yes" if row.given else "no"
        )
    out.print(table)


def _posture_table(path: str, rows: tuple[CheckedPosture, ...]) -> Table:
    table = Table(title=path, title_justify="left")
    for column in ("posture", "", "modes", "frequency off", "damping off", "within 95 %"):
        table.add_column(column)
    for row in rows:
        kind = "known to gap" if row.known else ("new, validation" if row.validation else "new")
        table.add_row(
            row.posture,
            kind,
            f"{row.n_paired} of {row.n_measured}",
            "" if row.f_error is None else f"{100 * row.f_error:.2f} %",
            "" if row.damping_error is None else f"{100 * row.damping_error:.1f} %",
            f"{row.within} of {row.n_paired}",
        )
    return table
