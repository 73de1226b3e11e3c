"""A named effect in a sentence: what, where, how large, how sure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from armodal.analyzer.gap.records import EffectFound, Interval, LineDeviation
from armodal.analyzer.report.arm_svg import MarkedAxis
from armodal.analyzer.report.words import plus_minus, rounded

__all__ = [
    "axis_of_effect",
    "certainty",
    "chance",
    "effect_sentence",
    "hidden_in_words",
    "interval_in_words",
    "largest_in_words",
    "mechanics",
    "mechanics_of",
    "size_in_words",
    "weight",
]

_OF_AN_AXIS = ("link", "direction", "point_m")
_K = "stiffness "
# A compliance is read as a stiffness; of a length of a link as its EI or GJ.
_INVERSE = {"rad/(N m)": "N m/rad", "m/N": "N/m", "rad/(N m²)": "N m²"}
_UNITS = {"_rad_s": "rad/s", "_rad": "rad", "_m": "m"}  # endings of a description's names
_LOGARITHM, _TIMES = "ln", "times"
# Below this a study of some thousand cases cannot tell a confidence from certainty.
_ALMOST_SURE = 0.999


def effect_sentence(effect: EffectFound) -> str:
    """Return what was found where, with its size where it has one."""
    size = size_in_words(effect)
    return f"{_what_where(effect.title, effect.place)}{f': {size}' if size else ''}."


def _what_where(title: str, place: str) -> str:
    """Name the place: "Link is compliant" in the shoulder is "The shoulder is compliant"."""
    does = title.removeprefix("Link ")
    if not place or does == title:
        return f"{title} ({place})" if place else title
    return f"The {place} {does}" if place.isalpha() else f"{place} {does}"


def size_in_words(effect: EffectFound) -> str:
    """Value ± standard deviation and 95 % interval of the parameter that says how large it is."""
    told = [name for name in (effect.size, *effect.sizes) if name in effect.parameters]
    if not told:
        return ""
    name = max(told, key=lambda name: abs(effect.parameters[name].value))
    words = interval_in_words(_as_factor(name, effect.parameters[name])[1])
    own = effect.words.get(name)
    return words if own is None else f"{own} {words.removeprefix(_K)}"


def interval_in_words(found: Interval) -> str:
    """Value ± standard deviation and 95 % interval; a compliance as the stiffness it is.

    Of a compliance that may be none only the least stiffness is known.
    """
    if found.unit in _INVERSE and found.low <= 0.0 < found.high:
        return f"{_K}at least {rounded(1.0 / found.high)} {_INVERSE[found.unit]} (95 %)"
    found, inverted = _as_stiffness(found)
    value, std = plus_minus(found.value, found.std)
    what = _K if inverted else ""
    unit = f" {found.unit}" if found.unit else ""
    return (
        f"{what}{value} ± {std}{unit} (95 %: {rounded(found.low)} to {rounded(found.high)}{unit})"
    )


def largest_in_words(largest: float, unit: str) -> str:
    """Return how large something could be and still hide; a compliance as the stiffness left.

    Examples
    --------
    >>> largest_in_words(0.004, "rad/(N m)")
    'no softer than 250 N m/rad'
    >>> largest_in_words(0.2, "kg")
    'no more than 0.200 kg'
    """
    if unit in _INVERSE and largest > 0.0:
        return f"no softer than {rounded(1.0 / largest)} {_INVERSE[unit]}"
    return f"no more than {rounded(largest)} {unit}".rstrip()


def hidden_in_words(parameter: str, largest: float, unit: str) -> tuple[str, str]:
    """Return what could hide, and how large it could be; a logarithm as the factor it is of.

    Examples
    --------
    >>> hidden_in_words("ln gain x", 0.0488, "")
    ('gain x', 'no more than 1.05 times')
    """
    name, told = _as_factor(
        parameter, Interval(unit=unit, value=largest, std=0.0, low=largest, high=largest)
    )
    return name, largest_in_words(told.value, told.unit)


def mechanics_of(effect: EffectFound) -> tuple[tuple[str, str], ...]:
    """Return an effect in the words of mechanics: what, and its words."""
    return mechanics(
        size=effect.size,
        parameters=effect.parameters,
        description=effect.description,
        line=effect.line,
        details=effect.details,
        words=effect.words,
        place=effect.place,
        confused_with=effect.confused_with,
        told_by=effect.told_by,
    )


def mechanics(
    *,
    size: str,
    parameters: Mapping[str, Interval],
    description: Mapping[str, object],
    line: LineDeviation | None = None,
    details: Sequence[str] = (),
    words: Mapping[str, str] | None = None,
    place: str,
    confused_with: Sequence[str],
    told_by: str,
) -> tuple[tuple[str, str], ...]:
    """Return stiffness and damping, axis, place and rivals of an effect, each named.

    `line` are the deviations of an axis' direction and place. `details` name parameters that people
    are not told, `words` tell those whose names do not do.
    """
    told_as = words or {}
    rows: list[tuple[str, str]] = []
    axis = _axis_in_words(description)
    if axis is not None:
        axis += _deviations(line)
    stiff = [name for name, found in parameters.items() if found.unit in _INVERSE]
    # Of what gives way about an axis, stiffness and damping say all; what swings has more to tell.
    swings = size in parameters and parameters[size].unit not in _INVERSE
    hidden = set(details)
    if axis is not None and not swings:
        hidden |= {*parameters} - {size}
    for name, found in parameters.items():
        if name not in hidden:
            told = told_as.get(name, name)
            if name in stiff and name not in told_as:
                told = _stiffness_name(name, found.unit, alone=axis is not None or len(stiff) == 1)
            told, own = _as_factor(told, found)
            rows.append((told, interval_in_words(own).removeprefix(_K)))
    damping = _damping(parameters.get(size), parameters) if axis is not None else ""
    if damping:
        rows.append(("c", damping))
    if axis is not None:
        rows.append(("axis", axis))
    where = place or "the whole arm"
    if axis is not None:
        where += " (in its frame: the axis' direction, and its point nearest the origin)"
    rows.append(("place", where))
    rows += [
        _entry(name, value)
        for name, value in description.items()
        if axis is None or name not in _OF_AN_AXIS
    ]
    rivals = "; ".join(confused_with) or "no other effect of the library"
    rows.append(("could be confused with", rivals))
    if told_by:
        rows.append(("told apart by", told_by))
    return tuple(rows)


def _stiffness_name(name: str, unit: str, *, alone: bool) -> str:
    if "compliance" not in name.split():
        return "k" if alone else f"k {name}"
    if unit == "rad/(N m²)":
        return name.replace("compliance", "stiffness")
    return "k" if alone else name.replace("compliance", "k")


def _axis_in_words(description: Mapping[str, object]) -> str | None:
    """Direction and point of a line of a link's frame; None of anything else."""
    link, direction, point = (description.get(key) for key in _OF_AN_AXIS)
    ways, at = _three(direction), _three(point)
    if not isinstance(link, str) or ways is None or at is None:
        return None
    way = " ".join(f"{round(x, 2) + 0.0:+.2f}" for x in ways)
    millimetres = " ".join(f"{1e3 * x + 0.0:.0f}" for x in at)
    return f"direction {way}, through {millimetres} mm"


def _deviations(line: LineDeviation | None) -> str:
    if line is None:
        return ""
    turned = rounded(float(np.degrees(line.turned_rad)))
    return f", ± {turned}° and ± {rounded(1e3 * line.shifted_m)} mm"


def _three(value: object) -> tuple[float, ...] | None:
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        return None
    return tuple(value) if all(isinstance(x, (int, float)) for x in value) else None


def _damping(size: Interval | None, parameters: Mapping[str, Interval]) -> str:
    """C of a compliance with one loss time c/k beside it, to first order, N m s/rad."""
    losses = [found for found in parameters.values() if found.unit == "s"]
    if size is None or size.unit != "rad/(N m)" or size.value <= 0.0 or len(losses) != 1:
        return ""
    c = losses[0].value / size.value
    value, std = plus_minus(c, float(np.hypot(losses[0].std, c * size.std)) / size.value)
    return f"{value} ± {std} N m s/rad"


def _entry(name: str, value: object) -> tuple[str, str]:
    """An entry of a description as people read it: its name without its unit."""
    if name == "link":
        return "in the frame of", _told(value)
    for ending, unit in _UNITS.items():
        if name.endswith(ending):
            return name.removesuffix(ending).replace("_", " "), f"{_told(value)} {unit}"
    return name.replace("_", " "), _told(value)


def _told(value: object) -> str:
    """An entry of a description."""
    if isinstance(value, (list, tuple)):
        return ", ".join(_told(part) for part in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def certainty(confidence: float) -> str:
    """Return the probability that it is this effect and no other one of the library, in words."""
    return "above 99.9 %" if confidence > _ALMOST_SURE else f"{100.0 * confidence:.3g} %"


def chance(probability: float | None) -> str:
    """Return how often a session without any effect would look as clear, in words."""
    if probability is None:
        return "not known"
    percent = 100.0 * probability
    return f"{percent:.2g} %" if percent < 10.0 else f"{percent:.0f} %"


def weight(odds: float | None) -> str:
    """Return how much evidence there is for a rival over that for the best one, in words."""
    return "not known" if odds is None else f"{odds:.2g}"


def axis_of_effect(effect: EffectFound) -> MarkedAxis | None:
    """Return the axis that an effect describes, if it describes one."""
    told = effect.description
    link, direction, point = (told.get(key) for key in ("link", "direction", "point_m"))
    if not isinstance(link, str) or direction is None or point is None:
        return None
    return MarkedAxis(
        link=link,
        direction_link=np.asarray(direction, dtype=np.float64),
        point_link_m=np.asarray(point, dtype=np.float64),
        label=f"{link}: {size_in_words(effect).partition(' (')[0]}",
    )


def _as_factor(name: str, found: Interval) -> tuple[str, Interval]:
    """A logarithm as what it is of, its deviation to first order; anything else as it is.

    Of what has no unit it is a factor.
    """
    words = name.split()
    if _LOGARITHM not in words:
        return name, found
    value, low, high = (float(np.exp(x)) for x in (found.value, found.low, found.high))
    unit = found.unit.removeprefix(f"{_LOGARITHM} ") or _TIMES
    own = Interval(unit=unit, value=value, std=value * found.std, low=low, high=high)
    return " ".join(word for word in words if word != _LOGARITHM), own


def _as_stiffness(found: Interval) -> tuple[Interval, bool]:
    """A compliance as a stiffness, its deviation to first order; anything else as it is."""
    unit = _INVERSE.get(found.unit)
    if unit is None or found.low <= 0.0:
        return found, False
    return Interval(
        unit=unit,
        value=1.0 / found.value,
        std=found.std / found.value**2,
        low=1.0 / found.high,
        high=1.0 / found.low,
    ), True
