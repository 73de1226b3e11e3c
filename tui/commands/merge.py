"""`armodal merge`: the FRFs of several hammers as one session."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from armodal import SOFTWARE
from armodal.analyzer.merge_sessions import merge_sessions
from armodal.protocols.session.hdf5 import Provenance, read_session, write_session
from armodal.tui.console import Json, out, print_json, print_note, say, say_next
from armodal.tui.output_file import check_output

__all__ = ["app"]

app = typer.Typer(add_completion=False)


@app.command()
def merge(
    sessions: Annotated[
        list[Path], typer.Argument(help="Session files (.h5), two or more, of the same points.")
    ],
    output: Annotated[Path, typer.Option("--out", "-o", help="Session file to write.")],
    as_json: Json = False,
) -> None:
    """Merge measurements with a soft and a hard hammer, each line weighted by its variance.

    Example: armodal merge soft.h5 hard.h5 --out both.h5
    """
    check_output(output, *sessions)
    measured = []
    for path in sessions:
        say(f"reading {path}")
        measured.append(read_session(path))
    merged, results = merge_sessions(
        measured,
        _names(sessions),
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        software=SOFTWARE,
    )
    write_session(merged, output, provenance=Provenance(journal_sha256=None, software=SOFTWARE))
    postures: list[dict[str, Any]] = [
        {
            "posture": posture,
            "lines": len(result.frf.freq_hz),
            "band_hz": [float(result.frf.freq_hz[0]), float(result.frf.freq_hz[-1])],
            "mean_weight": [float(w) for w in np.mean(result.weight, axis=(1, 2, 3))],
            "disagreements": len(result.disagreements),
        }
        for posture, result in results
    ]
    if as_json:
        print_json(
            {"session": str(output), "postures": postures, "warnings": list(merged.warnings)}
        )
        return
    for row in postures:
        low, high = row["band_hz"]
        out.print(f"{row['posture']}: {row['lines']} lines, {low:.4g} to {high:.5g} Hz")
    for text in merged.warnings:
        print_note(text)
    out.print(f"session {output}")
    say_next(f"fit {output}")


def _names(paths: list[Path]) -> list[str]:
    """Return file names, or paths where names are the same."""
    names = [path.name for path in paths]
    return names if len(set(names)) == len(names) else [str(path) for path in paths]
