"""`armodal export`: FRFs, shapes and identified models for other programs."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Any

import typer

from armodal import SOFTWARE
from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.identification.as_effects import identified_arm
from armodal.analyzer.identification.identify import estimate_frfs, identify
from armodal.analyzer.identification.records import Identification
from armodal.analyzer.modal import ModalModel, fit_modes, proposed_band, record_notes
from armodal.protocols.arm.records import PastSession
from armodal.protocols.arm.rewrite import text_with_effects
from armodal.protocols.errors import EstimateError, ForeignFileError
from armodal.protocols.foreign.export_uff import ExportedMode, posture_uff
from armodal.protocols.foreign.mat_write import write_mat, write_npz
from armodal.protocols.foreign.uff_write import write_uff
from armodal.protocols.session.hdf5 import read_session
from armodal.protocols.session.records import Session
from armodal.protocols.text_file import replace_text
from armodal.tui.command_parts.export_arm import export_arm, print_export
from armodal.tui.command_parts.identification_results import identification_json
from armodal.tui.command_parts.options import refuse_idle
from armodal.tui.console import Json, out, print_json, print_note, say, say_next
from armodal.tui.json_text import json_text
from armodal.tui.output_file import check_output

__all__ = ["app", "export_model"]

app = typer.Typer(add_completion=False)

_ARRAYS = {".mat": write_mat, ".npz": write_npz}
_ENDINGS, _MODEL_ENDINGS = (".uff", ".unv", ".mat", ".npz"), (".json", ".toml")


def export_session(
    session: Session,
    output: Path,
    *,
    modes: bool,
    binary: bool,
    software: str,
    band_hz: tuple[float, float] | None = None,
) -> dict[str, Any]:
    """Write the FRFs of every posture as UFF or, by the ending, MATLAB or NPZ; return a summary.

    The first posture goes to `output`, each further one to a file numbered behind it: names of
    postures never become paths.
    """
    _check_ending(output, _ENDINGS, "file")
    arm = session.header.arm
    frfs = estimate_frfs(session, Superset(arm), band_hz=band_hz)
    if not frfs:
        raise EstimateError("the session has no accepted hits and no FRFs: nothing to export")
    files: list[dict[str, Any]] = []
    left_out: list[str] = []
    for i, frf in enumerate(frfs):
        numbered = output.with_name(f"{output.stem}-{i + 1}{output.suffix}")
        path = output if len(frfs) == 1 else numbered
        said: tuple[str, ...] = ()
        fitted_hz: tuple[float, float] | None = None
        if output.suffix.lower() in _ARRAYS:
            _ARRAYS[output.suffix.lower()](frf, path)
        else:
            found: list[ExportedMode] = []
            if modes:
                band, why = proposed_band(frf) if band_hz is None else (band_hz, ())
                model = fit_modes(frf, band_hz=band)
                found, fitted_hz = _exported(model), model.band_hz
                left_out += why
            content, said = posture_uff(frf, arm, modes=found, software=software)
            write_uff(content, path, binary=binary)
        files.append(
            {
                "posture": frf.posture,
                "file": str(path),
                "modes_fitted_hz": fitted_hz,
                "notes": list(said),
            }
        )
    notes = [note for f in frfs for note in record_notes(session, f.posture, band_hz=band_hz)]
    return {"files": files, "warnings": [*session.warnings, *left_out, *notes]}


def _exported(model: ModalModel) -> list[ExportedMode]:
    return [
        ExportedMode(
            pole_rad_s=mode.pole_rad_s,
            shape=mode.shape,
            participation=mode.participation,
            words=(
                f"{mode.f_hz:.6f} Hz std {mode.f_std_hz:.2g}, damping "
                f"{100 * mode.damping_ratio:.5f} % std {100 * mode.damping_std:.2g}"
            ),
        )
        for mode in model.modes
    ]


def _check_ending(path: Path, endings: Sequence[str], what: str) -> None:
    if path.suffix.lower() not in endings:
        *others, last = endings
        raise ForeignFileError(
            f"{path.name}: wanted a {what} called {', '.join(others)} or {last}, got "
            f"{path.suffix or 'no ending'}; rename it"
        )


def export_model(
    session: Session, result: Identification, path: Path, *, software: str, session_sha256: str
) -> None:
    """Write the identified model: as JSON, or as the arm file with what was identified.

    A structural axis becomes an effect of the arm file, as `armodal gap` writes it.

    Raises
    ------
    ForeignFileError, ArmError
        If the ending is neither .json nor .toml, or the arm file cannot take the values.
    """
    _check_ending(path, _MODEL_ENDINGS, "model")
    if path.suffix.lower() == ".json":
        replace_text(path, json_text(identification_json(session, result)))
        return
    arm = session.header.arm
    source = f"identified by {software} from session {session.header.session_id[:8]}"
    now = datetime.now(UTC).isoformat(timespec="seconds")
    found = identified_arm(arm, result, source=source, session_sha256=session_sha256, created=now)
    fitted = {row.joint for row in result.joints}
    joints = [joint for joint in found.joints if joint.name in fitted]
    text = text_with_effects(
        arm,
        found.effects,
        stiffness={joint.name: joint.stiffness for joint in joints if joint.stiffness},
        damping={joint.name: joint.damping for joint in joints if joint.damping},
        past=[PastSession(session_sha256=session_sha256, by="armodal identify", created=now)],
    )
    replace_text(path, text)


@app.command("export")
def export_command(
    context: typer.Context,
    session: Annotated[
        Path, typer.Argument(metavar="SESSION|ARM", help="Session file (.h5), or an arm file.")
    ],
    output: Annotated[
        Path | None, typer.Option("--out", help="File to write: .uff, .unv, .mat or .npz.")
    ] = None,
    modes: Annotated[bool, typer.Option(help="Fit modes and write their shapes.")] = True,
    binary: Annotated[bool, typer.Option(help="UFF datasets 58 in binary form (58b).")] = False,
    model: Annotated[
        Path | None, typer.Option(help="Identified model too: .json, or .toml (arm file).")
    ] = None,
    band: Annotated[
        tuple[float, float] | None,
        typer.Option(help="Write FRFs from LOW to HIGH Hz, though hits excite less there."),
    ] = None,
    mjcf: Annotated[
        Path | None, typer.Option(help="Given an arm file: write it as MJCF, for MuJoCo.")
    ] = None,
    urdf: Annotated[Path | None, typer.Option(help="Given an arm file: write it as URDF.")] = None,
    sdf: Annotated[
        Path | None, typer.Option(help="Given an arm file: write it as SDF, for Gazebo.")
    ] = None,
    own: Annotated[
        Path | None,
        typer.Option(
            "--from", help="Your own MJCF or URDF of the arm, to which the effects are added."
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Write FRFs, geometry, mode shapes and the identified model for other programs.

    Given an arm file, it writes the corrected arm for simulators.

    Example: armodal export session.h5 --out session.uff --model model.json

    Example: armodal export demo/demo.arm.toml --mjcf arm.xml
    """
    if mjcf is not None or urdf is not None or sdf is not None:
        of_session = ("output", "modes", "binary", "model", "band")
        refuse_idle(context, of_session, here="--mjcf, --urdf or --sdf", there="a session")
        found = export_arm(str(session), mjcf=mjcf, urdf=urdf, sdf=sdf, own=own)
        print_export(str(session), found, as_json=as_json)
        return
    refuse_idle(context, ("own",), here="a session", there="--mjcf or --urdf")
    path = output or session.with_suffix(".uff")
    _check_ending(path, _ENDINGS, "file")
    check_output(path, session)
    if model is not None:
        _check_ending(model, _MODEL_ENDINGS, "model")
        check_output(model, session, path)
    measured = read_session(session)
    result = None if model is None else identify(measured, say)
    say("FRFs and modes" if modes else "FRFs")
    summary = export_session(
        measured, path, modes=modes, binary=binary, software=SOFTWARE, band_hz=band
    )
    if model is not None and result is not None:
        digest = sha256(session.read_bytes()).hexdigest()
        export_model(measured, result, model, software=SOFTWARE, session_sha256=digest)
    summary["model"] = None if model is None else str(model)
    if as_json:
        print_json(summary)
        return
    for file in summary["files"]:
        line = f"{file['posture']}: {file['file']}"
        if file["modes_fitted_hz"] is not None:
            low, high = file["modes_fitted_hz"]
            line += f", modes fitted from {low:.4g} to {high:.5g} Hz"
        out.print(line)
        for note in file["notes"]:
            out.print(f"  note: {note}")
    for text in summary["warnings"]:
        print_note(text)
    if model is not None:
        out.print(f"model {model}")
    say_next(f"report {session}")
