"""An arm file of a robot description."""

from __future__ import annotations

from armodal.tui.screens.home.choice import HomeChoice, HomeParts
from armodal.tui.screens.home.own_arm import DescriptionOfArm

__all__ = ["CHOICE"]


def _chosen(parts: HomeParts) -> None:
    parts.app.push_screen(DescriptionOfArm(parts.folder), parts.leave_with)


CHOICE = HomeChoice(
    key="o",
    label="own arm",
    words="own arm: make its file from a URDF, xacro or MJCF",
    place=50,
    in_key_line=False,
    chosen=_chosen,
)
