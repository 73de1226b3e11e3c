"""`armodal export ARM --mjcf OUT`: a corrected arm for simulators."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

from armodal.analyzer.export.by_mujoco import compare_frequencies, load_mujoco
from armodal.analyzer.export.exported import BELOW_HZ, Ready, ready_for_export
from armodal.analyzer.export.mjcf import mjcf_text
from armodal.analyzer.export.mjcf_patch import patched_mjcf
from armodal.analyzer.export.sdf import sdf_text
from armodal.analyzer.export.urdf import patched_urdf, urdf_text
from armodal.protocols.arm.files import load_arm
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError, MissingPackageError
from armodal.protocols.text_file import replace_text
from armodal.tui.console import out, print_json, print_note, say_next
from armodal.tui.output_file import check_output

__all__ = ["export_arm", "print_export"]

_POSTURES = 20
_AGREE = 2e-3  # relative: what a simulator's frequency may differ by


def export_arm(
    source: str, *, mjcf: Path | None, urdf: Path | None, sdf: Path | None, own: Path | None
) -> dict[str, Any]:
    """Write an arm for simulators; return what was written, checked and approximated.

    Parameters
    ----------
    own
        The user's own file, of which the export is a patch; None writes one from the arm file.

    Raises
    ------
    ArmError
        If an effect has no counterpart, the user's file is not of this arm, or MuJoCo's frequencies
        are not the arm file's.
    """
    arm = load_arm(source)
    outputs = [path for path in (mjcf, urdf, sdf) if path is not None]
    if own is not None and len(outputs) != 1:
        raise ArmError(
            f"--from: wanted one of --mjcf and --urdf, of which {own} is one, got {len(outputs)}"
        )
    if own is not None and sdf is not None:
        raise ArmError("--from: wanted --mjcf or --urdf, got --sdf; convert the URDF to SDF after")
    read = [path for path in (Path(source), own) if path is not None and path.exists()]
    for path in outputs:
        check_output(path, *read)
    ready = ready_for_export(arm)
    found: dict[str, Any] = {"arm": arm.name, "files": [], "notes": list(ready.notes)}
    found["effects"] = [f"{effect.name} ({effect.place})" for effect in arm.effects]
    found["elastic_joints"] = list(ready.tree.elastic)
    # What one of them refuses is known before any is written.
    texts: list[tuple[Path, str, tuple[str, ...]]] = []
    if urdf is not None:
        new = own is None and arm.urdf_text is None
        made = urdf_text(arm, ready.tree) if new else patched_urdf(arm, ready.tree, own)
        texts.append((urdf, *made))
    if sdf is not None:
        texts.append((sdf, *sdf_text(arm, ready.tree)))
    if mjcf is not None:
        _write_mjcf(arm, ready, mjcf, own, found)
    for path, text, notes in texts:
        _write(path, text, found, notes)
    return found


def print_export(arm: str, found: dict[str, Any], *, as_json: bool) -> None:
    """Print what `export_arm` did of an arm file."""
    if as_json:
        print_json(found)
        return
    out.print(f"with {', '.join(found['effects']) or 'no effects'}")
    out.print(f"elastic joints: {', '.join(found['elastic_joints'])}")
    if "mujoco" in found:
        checked = found["mujoco"]
        out.print(
            f"loaded by MuJoCo {checked['version']}: {checked['modes']} frequencies in "
            f"{checked['postures']} postures within {100 * checked['largest_difference']:.4f} % of "
            "the arm file's"
        )
    for note in found["notes"]:
        print_note(note)
    for path in found["files"]:
        out.print(f"written {path}")
    say_next(f"predict --arm {arm} --posture=DEG,DEG,...", "to compare with your simulator")


def _write(path: Path, text: str, found: dict[str, Any], notes: tuple[str, ...]) -> None:
    replace_text(path, text)
    found["files"].append(str(path))
    found["notes"] += notes


def _write_mjcf(
    arm: Arm, ready: Ready, path: Path, own: Path | None, found: dict[str, Any]
) -> None:
    """Write beside, have MuJoCo load it, compare, and only then put it in its place."""
    if own is not None:
        text, notes = patched_mjcf(arm, ready.tree, own, path, load_mujoco())
    else:
        text, notes = mjcf_text(arm, ready.tree), ()
    try:
        mujoco = load_mujoco()
    except MissingPackageError:
        _write(path, text, found, (*notes, "not checked: the package mujoco is not installed"))
        return
    handle, name = tempfile.mkstemp(prefix=".armodal-", suffix=".xml", dir=path.resolve().parent)
    beside = Path(name)
    try:
        os.close(handle)
        beside.write_text(text, encoding="utf-8")
        try:
            model = mujoco.MjModel.from_xml_path(str(beside))
        except ValueError as problem:
            raise ArmError(
                f"{path}: MuJoCo does not load what was to be written; nothing was written. Give "
                "--from a model without contacts, keyframes and actuators of other joints"
            ) from problem
        compared = compare_frequencies(
            ready.correction, ready.tree, mujoco, model, n_postures=_POSTURES, below_hz=BELOW_HZ
        )
        if compared.largest > _AGREE:
            raise ArmError(
                f"{path}: wanted MuJoCo's frequencies within {100 * _AGREE:.1f} % of the arm "
                f"file's, got {100 * compared.largest:.2f} % in {_POSTURES} postures; nothing was "
                f"written. {'; '.join(notes) or 'Check the arm file'}"
            )
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
    found["files"].append(str(path))
    found["notes"] += notes
    found["mujoco"] = {
        "version": mujoco.__version__,
        "postures": _POSTURES,
        "modes": compared.n_modes,
        "largest_difference": compared.largest,
    }
