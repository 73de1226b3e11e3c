"""Write other inertials into an arm file and leave everything else as it stands."""

from __future__ import annotations

from collections.abc import Sequence

import tomlkit

from protocols.arm.records import InertialLink

__all__ = ["text_with_inertials"]

_DIGITS = 6


def text_with_inertials(text: str, links: Sequence[InertialLink], *, name: str, source: str) -> str:
    """Return an arm file's text with the inertials of its links replaced.

    Parameters
    ----------
    text
        An arm file that has been read without error.
    links
        One per joint, base outwards.
    name, source
        Of the new arm; the source says where the inertials come from.
    """
    document = tomlkit.parse(text)
    document["name"] = name
    document["source"] = source
    document.pop("masses", None)  # every link gets its own mass
    joints = document["joints"]
    for joint, link in zip(joints, links, strict=True):
        inertia = link.inertia_kg_m2
        table = tomlkit.inline_table()
        table["name"] = link.name
        table["mass_kg"] = _short(link.mass_kg)
        table["center_m"] = [_short(value) for value in link.center_m]
        table["inertia_kg_m2"] = [
            _short(inertia[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
        ]
        joint["link"] = table
    return tomlkit.dumps(document)


def _short(value: float) -> float:
    # What is below a nanometre or a nano kg m² is rounding of a zero.
    return 0.0 if abs(value) < 1e-9 else float(f"{value:.{_DIGITS}g}")
