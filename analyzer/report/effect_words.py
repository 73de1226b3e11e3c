"""A named effect in a sentence: what, where, how large, how sure."""

from __future__ import annotations

import numpy as np

from armodal.analyzer.gap.records import EffectFound, Interval
from armodal.analyzer.report.arm_svg import MarkedAxis
from armodal.analyzer.report.words import plus_minus, rounded

__all__ = [
    "axis_of_effect",
    "certainty",
    "chance",
    "effect_sentence",
    "interval_in_words",
    "size_in_words",
]

_INVERSE = {"rad/(N m)": "N m/rad", "m/N": "N/m"}  # a compliance is read as a stiffness
# Below this a study of some thousand cases cannot tell a confidence from certainty.
_ALMOST_SURE = 0.999
_HARDLY_EVER = 1e-4  # far beyond the replicas: their tail's form is assumed


def effect_sentence(effect: EffectFound) -> str:
    """Return what was found where, with its size where it has one."""
    place = f" ({effect.place})" if effect.place else ""
    size = size_in_words(effect)
    return f"{effect.title}{place}{f': {size}' if size else ''}."


def size_in_words(effect: EffectFound) -> str:
    """Value ± standard deviation and 95 % interval of the parameter that says how large it is."""
    found = effect.parameters.get(effect.size)
    return "" if found is None else interval_in_words(found)


def interval_in_words(found: Interval) -> str:
    """Value ± standard deviation and 95 % interval; a compliance as the stiffness it is."""
    found, inverted = _as_stiffness(found)
    value, std = plus_minus(found.value, found.std)
    what = "stiffness " if inverted else ""
    unit = f" {found.unit}" if found.unit else ""
    return (
        f"{what}{value} ± {std}{unit} (95 %: {rounded(found.low)} to {rounded(found.high)}{unit})"
    )


def certainty(effect: EffectFound) -> str:
    """Return the probability that it is this effect and no other one of the library, in words."""
    if effect.confidence > _ALMOST_SURE:
        return "above 99.9 %"
    return f"{100.0 * effect.confidence:.3g} %"


def chance(probability: float | None) -> str:
    """Return how often a session without any effect would look as clear, in words."""
    if probability is None:
        return "not known"
    if probability < _HARDLY_EVER:
        return f"below {100.0 * _HARDLY_EVER:g} %"
    percent = 100.0 * probability
    return f"{percent:.2g} %" if percent < 10.0 else f"{percent:.0f} %"


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
