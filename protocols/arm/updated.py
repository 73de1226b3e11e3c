"""An arm file with stiffness and damping put in from an identification."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass

from armodal.protocols.arm.files import arm_from_texts
from armodal.protocols.arm.records import Arm
from armodal.protocols.errors import ArmError

__all__ = ["JointValues", "arm_text_with"]

_TABLE = re.compile(r"^\s*\[")
_NAME = re.compile(r"^\s*name\s*=\s*(\"[^\"\\]*\"|'[^']*')\s*(#.*)?$")
_ENTRY = re.compile(r"^\s*(stiffness_n_m_per_rad|damping_n_m_s_per_rad)\s*=\s*\{[^}]*\}\s*(#.*)?$")


@dataclass(frozen=True, slots=True, kw_only=True)
class JointValues:
    """Identified stiffness (N m/rad) and damping (N m s/rad) with one standard deviation."""

    stiffness: tuple[float, float]
    damping: tuple[float, float]


def arm_text_with(arm: Arm, values: Mapping[str, JointValues], source: str) -> str:
    """Return the arm's text with the values of the joints named; all else is untouched.

    Raises
    ------
    ArmError
        If the file writes those values in a way that cannot be replaced line by line.
    """
    lines, joint = arm.text.splitlines(), ""
    for i, line in enumerate(lines):
        if _TABLE.match(line):
            joint = ""
        if (match := _NAME.match(line)) and not joint:
            joint = match[1][1:-1]
        if (match := _ENTRY.match(line)) and joint in values:
            own = values[joint]
            value, std = own.stiffness if match[1].startswith("stiff") else own.damping
            lines[i] = (
                f"{match[1]} = {{ value = {float(value)!r}, std = {float(std)!r}, "
                f"source = {json.dumps(source, ensure_ascii=False)} }}"
            )
    text = "\n".join(lines) + "\n"
    database = None if arm.can is None else arm.can.database_text
    changed = arm_from_texts(text, urdf_text=arm.urdf_text, database_text=database)
    for found in changed.joints:
        wanted = values.get(found.name)
        if wanted is not None and (
            found.stiffness is None
            or found.damping is None
            or found.stiffness.value != wanted.stiffness[0]
            or found.damping.value != wanted.damping[0]
        ):
            raise ArmError(
                f"arm {arm.name!r}: joint {found.name}: wanted stiffness and damping on lines of "
                "their own, as inline tables; write them so, or export the model as JSON"
            )
    return text
