"""Units as files of other programs tell them, and the factors to SI.

A universal file tells its units twice: dataset 164 (length and force) and the labels of the
ordinate of dataset 58. Neither has to be there, and the two need not agree.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.uff_records import DataKind, UffUnits

__all__ = [
    "QUANTITIES",
    "SI",
    "Scale",
    "hertz",
    "length_scale",
    "seconds",
    "signal_scale",
    "unit",
]

SI = "SI"  # the unit that SI has for whatever quantity it is

_G = 9.80665
_INCH, _FOOT = 0.0254, 0.3048
_POUND = 4.4482216152605
_SAME = 1e-4  # relative: 9.81 for 9.80665 is a different unit, 9.8067 is not

_LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": _INCH, "ft": _FOOT}
_FORCES = {"n": 1.0, "kn": 1e3, "mn": 1e-3, "cn": 1e-2, "lbf": _POUND, "lb": _POUND, "kgf": _G}
_TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
_FREQUENCIES = {"hz": 1.0, "khz": 1e3, "mhz": 1e-3, "rad/s": 1.0 / (2.0 * math.pi)}
_WORDS = {
    "newton": "N", "newtons": "N", "meters": "m", "meter": "m", "seconds": "s", "second": "s",
    "hertz": "Hz", "gs": "g",
}  # fmt: skip
QUANTITIES = {
    DataKind.DISPLACEMENT: "displacement",
    DataKind.VELOCITY: "velocity",
    DataKind.ACCELERATION: "acceleration",
    DataKind.EXCITATION_FORCE: "force",
    DataKind.REACTION_FORCE: "force",
}
# Dataset 164, units code: factors by which SI is multiplied to give the file's numbers.
_CODES = {
    1: (1.0, 1.0),
    2: (1 / _FOOT, 1 / _POUND),
    3: (1.0, 1 / _G),
    4: (1 / _FOOT, 1 / 0.138254954376),
    5: (1e3, 1e3),
    6: (1e2, 1e2),
    7: (1 / _INCH, 1 / _POUND),
    8: (1e3, 1 / _G),
}


@dataclass(frozen=True, slots=True)
class Scale:
    """The factor that turns the file's numbers into SI; `assumed` says that nobody told."""

    factor: float
    assumed: bool


def _table() -> dict[str, tuple[str, float]]:
    table: dict[str, tuple[str, float]] = {}
    for name, factor in _LENGTHS.items():
        table[name] = ("displacement", factor)
        for text in (f"{name}/s", f"{name}s-1", f"{name}*s-1"):
            table[text] = ("velocity", factor)
        for text in (f"{name}/s2", f"{name}/s/s", f"{name}s-2", f"{name}*s-2"):
            table[text] = ("acceleration", factor)
    for name in ("g", "gn", "g0", "gee"):
        table[name] = ("acceleration", _G)
    table["mg"] = ("acceleration", 1e-3 * _G)
    table |= {name: ("force", factor) for name, factor in _FORCES.items()}
    return table


_UNITS = _table()


def unit(label: str) -> tuple[str, float] | None:
    """Return the quantity and the factor to SI of a unit's label; None if it is not known.

    >>> unit("m/s^2")
    ('acceleration', 1.0)
    >>> unit("V") is None
    True
    """
    text = _plain(label)
    if text in {"MN", "Mn"}:  # meganewton beside millinewton
        return "force", 1e6
    return _UNITS.get(text.lower())


def seconds(label: str) -> float | None:
    """Return the factor to s of a unit of time; None if it is not known.

    >>> seconds("ms")
    0.001
    >>> seconds("h") is None
    True
    """
    return _TIMES.get(_plain(label).lower())


def hertz(label: str) -> float | None:
    """Return the factor to Hz of a unit of frequency; None if it is not known.

    >>> hertz("kHz")
    1000.0
    """
    return _FREQUENCIES.get(_plain(label).lower())


def _plain(label: str) -> str:
    text = label.strip()
    for old, new in (("²", "2"), ("µ", "u"), ("μ", "u"), ("·", "*")):
        text = text.replace(old, new)
    for mark in (" ", "^", "**", "(", ")", "[", "]"):
        text = text.replace(mark, "")
    return _WORDS.get(text.lower(), text.replace("sec", "s"))


def signal_scale(kind: int, label: str, units: UffUnits | None, origin: str) -> Scale:
    """Return the factor to SI of a motion or force.

    The label and dataset 164 are both heard; where they contradict one another, or the label
    tells another quantity, the file is refused.

    Raises
    ------
    ForeignFileError
        If the units contradict one another.
    """
    wanted = QUANTITIES.get(DataKind(kind))
    if label == SI:
        return Scale(1.0, assumed=False)
    told = unit(label) if label else None
    if label and told is None:
        raise ForeignFileError(
            f"{origin}: wanted a unit of {wanted} such as m/s^2, g, m/s, m or N, the ordinate's "
            f"unit {label!r} came; say `units` in the manifest"
        )
    if told is not None and told[0] != wanted:
        raise ForeignFileError(
            f"{origin}: the data type tells {wanted}, the ordinate's unit {label!r} tells "
            f"{told[0]}; say `units` and `form` in the manifest"
        )
    by_164 = None
    if units is not None:
        length, force = length_scale(units, origin), _force_scale(units, origin)
        by_164 = force if wanted == "force" else length
    if told is not None and by_164 is not None and abs(told[1] / by_164 - 1.0) > _SAME:
        raise ForeignFileError(
            f"{origin}: dataset 164 makes the unit of {wanted} {by_164:g} of SI, the ordinate's "
            f"label {label!r} makes it {told[1]:g}; say `units` in the manifest"
        )
    if told is not None:
        return Scale(told[1], assumed=False)
    return Scale(1.0, assumed=True) if by_164 is None else Scale(by_164, assumed=False)


def length_scale(units: UffUnits | None, origin: str) -> float:
    """Return metres per length unit of the file; 1 where there is no dataset 164."""
    if units is None:
        return 1.0
    _check_code(units, origin)
    return 1.0 / units.length


def _force_scale(units: UffUnits, origin: str) -> float:
    _check_code(units, origin)
    return 1.0 / units.force


def _check_code(units: UffUnits, origin: str) -> None:
    """Refuse a units code that its factors contradict: one of the two is wrong."""
    expected = _CODES.get(units.code)
    if expected is None:
        return
    for name, told, should in zip(
        ("length", "force"), (units.length, units.force), expected, strict=True
    ):
        if abs(told / should - 1.0) > 1e-3:
            raise ForeignFileError(
                f"{origin}: dataset 164: units code {units.code} means a {name} factor of "
                f"{should:g}, {told:g} came: one of the two is wrong; say `units` in the manifest"
            )
