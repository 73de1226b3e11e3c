"""`armodal import`: a session file of measurements from other programs."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import typer

from armodal import SOFTWARE
from armodal.analyzer.given_frfs import with_variances
from armodal.daq.judge_imported import judged
from armodal.protocols.foreign.files_in import files_in
from armodal.protocols.foreign.import_session import import_session
from armodal.protocols.foreign.manifest import load_manifest
from armodal.protocols.session.hdf5 import Provenance, write_session
from armodal.protocols.session.records import Session
from armodal.tui.command_parts.guessed_manifest import (
    guess_json,
    is_manifest,
    manifest_beside,
    unanswered,
)
from armodal.tui.console import Json, out, print_json, print_note, say, say_next
from armodal.tui.output_file import check_output

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command("import")
def import_command(
    files: Annotated[
        list[Path],
        typer.Argument(help="Import manifest (TOML), or measured files or a folder of them alone."),
    ],
    output: Annotated[Path, typer.Option("--out", help="Session file to write.")],
    as_json: Json = False,
) -> None:
    """Make a session file of measurements from other programs.

    Without a manifest one is guessed, written beside the session, and followed if nothing is in
    doubt.

    Example: armodal import manifest.toml --out session.h5
    """
    said: dict[str, Any] = {}
    files = files_in(files)
    manifest = files[0]
    if not is_manifest(files):
        check_output(output, *files)
        manifest, guess = manifest_beside(files, output)
        said = guess_json(manifest, guess)
        if guess.doubts:
            if as_json:
                print_json(said)
            raise unanswered(manifest, guess)
    say(f"reading {manifest}")
    _, summary = import_manifest(manifest, output, software=SOFTWARE)
    if as_json:
        print_json({**summary, **said})
        return
    for text in said.get("guesses", ()):
        out.print(f"guess: {text}")
    for posture in summary["postures"]:
        what = f"{posture.get('frfs')} FRFs"
        if "hits" in posture:
            what = f"{posture['hits']} hits, {posture['accepted']} accepted"
        out.print(f"{posture['posture']}: {what}")
    for text in summary["warnings"]:
        print_note(text)
    out.print(f"session {output}")
    say_next(f"review {output}")


def import_manifest(path: Path, output: Path, *, software: str) -> tuple[Session, dict[str, Any]]:
    """Write the session a manifest describes; return it and a summary in plain values."""
    check_output(output, path)
    created = datetime.now(UTC).isoformat(timespec="seconds")
    session = import_session(load_manifest(path), created=created, software=software)
    session = with_variances(judged(session))
    write_session(session, output, provenance=Provenance(journal_sha256=None, software=software))
    return session, {
        "session": str(output),
        "arm": session.header.arm.name,
        "mode": str(session.header.plan.mode),
        "postures": [
            _posture_summary(session, posture.name) for posture in session.header.plan.postures
        ],
        "warnings": list(session.warnings),
    }


def _posture_summary(session: Session, name: str) -> dict[str, Any]:
    hits = [hit for hit in session.hits if hit.posture == name]
    if hits:
        points = dict.fromkeys(hit.sensor_point for hit in hits)
        accepted = len(session.accepted(name))
        return {"posture": name, "hits": len(hits), "accepted": accepted, "points": list(points)}
    frf = next(frf for frf in session.frfs if frf.posture == name)
    return {
        "posture": name,
        "frfs": len(frf.responses) * len(frf.references),
        "form": str(frf.form),
        "lines": len(frf.freq_hz),
        "band_hz": [float(frf.freq_hz[0]), float(frf.freq_hz[-1])],
        "points": list(dict.fromkeys(dof.point for dof in frf.responses)),
    }
