"""`armodal recover`: the session file of a journal."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from armodal import SOFTWARE
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.identify import estimate_frfs
from armodal.protocols.errors import SessionError
from armodal.protocols.frf_records import FrequencyResponse
from armodal.protocols.session.records import Session
from armodal.protocols.session.recovery import Recovery, rebuild
from armodal.protocols.session.salvage_files import rebuild_salvaged
from armodal.tui.console import Json, out, print_json, say_next

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command()
def recover(
    journal: Annotated[Path, typer.Argument(help="Journal of an interrupted session.")],
    output: Annotated[Path | None, typer.Option("--out", help="Session file to write.")] = None,
    salvage: Annotated[
        bool,
        typer.Option("--salvage", help="Take every whole record, behind damage too."),
    ] = False,
    header: Annotated[
        Path | None,
        typer.Option("--header", help="Journal of the same arm and plan; with --salvage."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Rebuild the session file from a journal, and say what was recovered and dropped.

    A journal that is damaged in its middle, or that holds two sessions, is salvaged: what is whole
    goes into NAME.salvaged-1.journal and its session file, one for each session.

    Example: armodal recover session.journal
    """
    if salvage:
        if output is not None:
            raise SessionError("--salvage names the files it writes itself; leave out --out")
        _salvage(journal, header, as_json=as_json)
        return
    if header is not None:
        raise SessionError("--header goes with --salvage; give both, or neither")
    path = output or journal.with_suffix(".h5")
    found = rebuild(journal, path, software=SOFTWARE, estimate_frfs=_frfs)
    _show({"session": str(path), **_told_of(found)}, as_json=as_json)
    if not as_json:
        say_next(f"review {path}")


def _salvage(journal: Path, header: Path | None, *, as_json: bool) -> None:
    found, files = rebuild_salvaged(
        journal, software=SOFTWARE, header_of=header, estimate_frfs=_frfs
    )
    sessions = [
        {
            "session_id": file.recovery.session.header.session_id,
            "journal": str(file.journal),
            "session": str(file.session_file),
            "resolved": list(file.salvaged.notes),
            **_told_of(file.recovery),
        }
        for file in files
    ]
    if as_json:
        print_json({"taken": found.taken, "dropped": list(found.dropped), "sessions": sessions})
        return
    out.print(f"{'whole records':<16}{found.taken} taken")
    for dropped in found.dropped:
        out.print(f"{'dropped':<16}{dropped}")
    for session in sessions:
        out.print("")
        _show(session, as_json=False)
    say_next(f"check session {files[0].session_file}", "keep the damaged journal")


def _show(summary: dict[str, object], *, as_json: bool) -> None:
    if as_json:
        print_json(summary)
        return
    for name, value in summary.items():
        out.print(f"{name:<16}{value}")


def _told_of(found: Recovery) -> dict[str, object]:
    return {
        "hits": {"accepted": found.accepted, "rejected": found.rejected},
        "recovered_bytes": found.recovered_bytes,
        "dropped_bytes": found.dropped_bytes,
        "complete": found.session.complete,
        "warnings": list(found.session.warnings),
        "frf_problem": found.frf_problem,
    }


def _frfs(session: Session) -> tuple[FrequencyResponse, ...]:
    return tuple(estimate_frfs(session, Superset(session.header.arm)))
