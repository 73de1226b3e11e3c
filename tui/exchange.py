"""`armodal import` and `armodal export`: measurements from and for other programs."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from analyzer.given_frfs import with_variances
from protocols.foreign.import_session import import_session
from protocols.foreign.manifest import load_manifest
from protocols.session.hdf5 import Provenance, write_session
from protocols.session.records import Session

__all__ = ["add_exchange_commands", "import_manifest"]

Json = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


def import_manifest(path: Path, output: Path, *, software: str) -> tuple[Session, dict[str, Any]]:
    """Write the session a manifest describes; return it and a summary in plain values."""
    created = datetime.now(UTC).isoformat(timespec="seconds")
    session = import_session(load_manifest(path), created=created, software=software)
    session = with_variances(session)
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
    hits = session.accepted(name)
    if hits:
        points = dict.fromkeys(hit.sensor_point for hit in hits)
        return {"posture": name, "hits": len(hits), "points": list(points)}
    frf = next(frf for frf in session.frfs if frf.posture == name)
    return {
        "posture": name,
        "frfs": len(frf.responses) * len(frf.references),
        "form": str(frf.form),
        "lines": len(frf.freq_hz),
        "band_hz": [float(frf.freq_hz[0]), float(frf.freq_hz[-1])],
        "points": list(dict.fromkeys(dof.point for dof in frf.responses)),
    }


def add_exchange_commands(
    app: typer.Typer, *, software: str, out: Console, say: Callable[[str], None]
) -> None:
    """Register `import` and `export` with the command line."""

    @app.command("import")
    def import_command(
        manifest: Annotated[Path, typer.Argument(help="Import manifest (TOML).")],
        output: Annotated[Path, typer.Option("--out", help="Session file to write.")],
        as_json: Json = False,
    ) -> None:
        """Make a session file of measurements from other programs.

        Example: armodal import manifest.toml --out session.h5
        """
        say(f"reading {manifest}")
        _, summary = import_manifest(manifest, output, software=software)
        if as_json:
            sys.stdout.write(json.dumps(summary, indent=2) + "\n")
            return
        for posture in summary["postures"]:
            what = f"{posture['hits']} hits" if "hits" in posture else f"{posture['frfs']} FRFs"
            out.print(f"{posture['posture']}: {what}", markup=False)
        for text in summary["warnings"]:
            out.print(f"note: {text}", markup=False)
        out.print(f"session {output}", markup=False)
