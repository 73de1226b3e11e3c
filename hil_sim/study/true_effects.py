"""The truth of a case as a verdict tells it: names, sizes, places.

Each effect's file knows its own (`hil_sim/effects/compared.py`). Effects of other makers are
compared likewise, by the names of their parameters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from armodal.hil_sim.effects import modules_with
from armodal.hil_sim.effects.compared import Compared, TrueEffect

__all__ = ["description", "name_of", "ordinary_beside", "places_of", "size_of_truth"]

_COMPARED: Mapping[str, Compared] = {
    name: compared
    for module in modules_with("COMPARED").values()
    for name, compared in module.COMPARED.items()
}
_PLAIN = Compared()


def name_of(effect: Mapping[str, Any], case: Mapping[str, Any]) -> str:
    """Return the name that a verdict should give an effect of a case."""
    own = _of(effect)
    other = own.named(_true(effect, case)) if own.named else None
    return str(effect["name"]) if other is None else other


def size_of_truth(
    effect: Mapping[str, Any],
    stiffness: Mapping[str, float],
    told: Mapping[str, object] | None = None,
) -> float | None:
    """Return the true value of what an effect's size parameter measures; None if it has no such.

    Parameters
    ----------
    effect
        The true one.
    stiffness
        Believed stiffness of each joint, N m/rad.
    told
        How the effect found describes itself.
    """
    own = _of(effect)
    true = TrueEffect(
        place=effect["place"],
        parameters=effect["parameters"],
        believed_n_m_per_rad=stiffness,
        found=told or {},
    )
    try:
        return own.size(true) if own.size else None
    except KeyError:  # of another maker, which tells another quantity
        return None


def ordinary_beside(effect: Mapping[str, Any], case: Mapping[str, Any]) -> float:
    """Return what a true arm has of the same kind anyway, in the size's unit."""
    own = _of(effect)
    return own.beside(_true(effect, case)) if own.beside else 0.0


def places_of(effect: Mapping[str, Any]) -> Sequence[str]:
    """Return an effect's places in the library's words."""
    own, place = _of(effect), effect["place"]
    if own.places:
        return own.places(_true(effect, {}))
    return [place] if isinstance(place, str) else list(place)


def description(effect: Mapping[str, Any]) -> Mapping[str, object] | None:
    """Return where and how it stands in an arm file's words; None where its place tells."""
    own = _of(effect)
    return own.described(_true(effect, {})) if own.described else None


def _of(effect: Mapping[str, Any]) -> Compared:
    return _COMPARED.get(str(effect["name"]), _PLAIN)


def _true(effect: Mapping[str, Any], case: Mapping[str, Any]) -> TrueEffect:
    return TrueEffect(place=effect["place"], parameters=effect["parameters"], case=case)
