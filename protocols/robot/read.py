"""A robot description by its file's kind: URDF, xacro or MJCF."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from armodal.protocols.errors import ArmError
from armodal.protocols.robot.mjcf import read_mjcf
from armodal.protocols.robot.records import Robot
from armodal.protocols.robot.remarks import Remarks
from armodal.protocols.robot.urdf_tree import read_tree
from armodal.protocols.robot.xacro_text import expand_xacro
from armodal.protocols.toml_reader import read_text

__all__ = ["MOST_DESCRIPTION_BYTES", "read_robot"]

MOST_DESCRIPTION_BYTES = 16 * 2**20
_KINDS = ".urdf, .xacro or .xml (MJCF)"


def read_robot(
    path: Path,
    said: Remarks,
    *,
    folders: Sequence[Path] = (),
    arguments: Mapping[str, str] | None = None,
) -> Robot | None:
    """Read a robot description.

    Parameters
    ----------
    folders
        Where packages are looked for first.
    arguments
        Values of a xacro file's arguments.

    Returns
    -------
    Robot or None
        None where nothing can be read; `said` tells why.

    Raises
    ------
    ArmError
        If there is no such file, or it is of another kind.
    MissingPackageError
        If the file's kind needs a package that is not installed.
    """
    text = read_text(
        path, what="robot description", limit_bytes=MOST_DESCRIPTION_BYTES, error=ArmError
    )
    if path.suffix.lower() == ".xacro":
        try:
            text = expand_xacro(path, folders=folders, arguments=dict(arguments or {}))
        except ArmError as problem:
            said.fault("xacro", str(problem))
            return None
    elif arguments:
        raise ArmError(f"wanted xacro arguments with a .xacro file only, got {path.name}")
    if path.suffix.lower() == ".xml" and "<mujoco" in text:
        return read_mjcf(path, said)
    if path.suffix.lower() not in {".urdf", ".xacro", ".xml"}:
        raise ArmError(f"wanted a robot description of the kind {_KINDS}, got {path.name}")
    return read_tree(text, path.parent, said, folders=folders)
