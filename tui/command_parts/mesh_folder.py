"""Where the meshes of an arm lie."""

from __future__ import annotations

from pathlib import Path

from armodal.protocols.arm.files import shipped_arms

__all__ = ["mesh_folder"]


def mesh_folder(arm: str) -> Path | None:
    """Return the folder of an arm file; None for a shipped arm, whose meshes are not shipped."""
    return None if arm in shipped_arms() else Path(arm).parent
