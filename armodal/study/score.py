"""How a study's verdicts compare with the truth: counts, rates with their intervals, errors.

A name is wrong when it is not true.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import scipy

from armodal.analyzer.gap.library import described, instances_named
from armodal.analyzer.gap.model.effect import Instance
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.records import EffectFound, GapResult, Verdict
from armodal.hil_sim.study.true_effects import description, name_of, places_of

__all__ = [
    "Marked",
    "Rate",
    "instance_of_truth",
    "mark",
    "rate",
    "size_found",
]

_WHOLE = {"all", "hammer", "accelerometer", "base"}  # places of what concerns the whole lab
OUTCOMES = ("right", "ambiguous with the truth", "unsure", "missed", "outside", "wrong name")


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """k of n with its 95 % Clopper-Pearson interval."""

    k: int
    n: int
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Marked:
    """One case, marked."""

    outcome: str  # one of OUTCOMES
    named: tuple[str, ...]
    true: tuple[str, ...]
    n_true_named: int
    standing: tuple[str, ...]
    places: tuple[str, ...]  # of what is named
    place_right: bool | None  # of a single effect named right


def rate(k: int, n: int) -> Rate:
    """A rate with its exact interval (Clopper and Pearson, Biometrika 26 (1934) 404)."""
    low = 0.0 if k == 0 else float(scipy.special.betaincinv(k, n - k + 1, 0.025))
    high = 1.0 if k == n else float(scipy.special.betaincinv(k + 1, n - k, 0.975))
    return Rate(k=k, n=n, low=low, high=high)


def mark(truth: Mapping[str, Any], result: GapResult) -> Marked:
    """Mark a verdict.

    Parameters
    ----------
    truth
        `verdict` and `effects`, a list of `{name, place, parameters}`.
    """
    true = [name_of(effect, truth) for effect in truth["effects"]]
    named = [effect.name for effect in result.effects]
    counted = named if result.verdict is Verdict.NAMED else []
    standing = tuple(r.name for r in result.rivals if r.standing)
    hits, wrong = [], list(counted)
    for t in true:  # each for itself: a true name said twice is once too often
        if t in wrong:
            hits.append(t)
            wrong.remove(t)
    is_outside = truth["verdict"] == "outside_library"
    if wrong:
        outcome = "wrong name"
    elif result.verdict is Verdict.OUTSIDE_LIBRARY:
        outcome = "right" if is_outside else "outside"
    elif result.verdict is Verdict.AMBIGUOUS:
        inside = any(t in standing for t in true)
        outcome = "ambiguous with the truth" if inside else "unsure"
    elif not counted:
        outcome = "missed" if true else "right"
    else:
        outcome = "right" if len(hits) == len(true) else "missed"
    place = None
    if outcome == "right" and len(true) == 1 and counted:
        first = next(e for e in result.effects if e.name == true[0])
        place = _same_place(truth["effects"][0], first.place)
    return Marked(
        outcome=outcome,
        named=tuple(counted),
        true=tuple(true),
        n_true_named=len(hits),
        standing=standing,
        places=tuple(effect.place for effect in result.effects) if counted else (),
        place_right=place,
    )


def _same_place(true: Mapping[str, Any], ours: str) -> bool:
    """Whether our words are of the place, word by word, and of the sensor's axis where it has one.

    What concerns the whole lab is told at no single point or posture, or without any place.
    """
    place = true["place"]
    places = set(place if isinstance(place, list) else [place])
    words = set(re.findall(r"[^\s:,]+", ours))
    axes = true["parameters"].get("axes", true["parameters"].get("axis"))
    if axes and set(axes) <= set("xyz") and words & set("xyz") != set(axes):
        return False
    posture = true["parameters"].get("posture")
    if posture is not None:  # of one alone
        return ours == f"posture {posture}"
    if places <= _WHOLE:
        return not words & {"point", "points", "posture"}
    return not ours or places - _WHOLE <= words


def instance_of_truth(ordinary: Ordinary, effect: Mapping[str, Any]) -> Instance | None:
    """The library's instance of a true effect; None where only a search could place it."""
    name, told = effect["name"], description(effect)
    if told is not None:
        return described(ordinary, name, told)
    places = set(places_of(effect))
    fitting = instances_named(ordinary, name)
    found = [i for i in fitting if not i.place or set(i.place.split(" and ")) == places]
    return found[0] if len(found) == 1 or (found and not found[0].place) else None


def size_found(effect: EffectFound) -> tuple[float, float, float]:
    """Value and 95 % interval of the parameter that says how large an effect is."""
    interval = effect.parameters[effect.size]
    return interval.value, interval.low, interval.high
