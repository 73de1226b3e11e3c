"""Cases by maker, seed, arm and effect."""

from __future__ import annotations

from importlib import import_module, util
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

from armodal.hil_sim.makers.arms import ARMS, WRISTS, arm_table
from armodal.hil_sim.makers.case import SIZES, Case, CaseSpec
from armodal.protocols.errors import PlantError

__all__ = ["MAKERS", "arms_of", "case_of", "effects_of", "make_case", "wrists_of"]

_HERE = Path(__file__).parent
MAKERS = tuple(sorted(m.name for m in iter_modules([str(_HERE)]) if m.ispkg and m.name != "arms"))
_NEEDS = {"mujoco": "mujoco"}


def make_case(
    maker: str,
    seed: int,
    arm: str,
    effect: str | tuple[str, ...] | None = None,
    size_class: str = "clear",
    *,
    wrist: str = "elastic",
    number: int = 1,
) -> Case:
    """Close a case.

    Parameters
    ----------
    maker
        One of `MAKERS`.
    seed
        Decides everything; each cause draws from a stream of its own.
    arm
        One of `ARMS`.
    effect
        Name in `effects_of(maker)`, several of them, or None for a null.
    size_class
        "faint", "medium" or "clear": how far it stands out of what is ordinary.
    wrist
        "elastic": every joint gives way; "rigid": the wrist's do not.

    Raises
    ------
    PlantError
        If a name is unknown, the effect has no place in this arm, or a package is not installed.
    """
    kinds = () if effect is None else (effect,) if isinstance(effect, str) else effect
    for what, name, known in (
        ("arm", arm, ARMS),
        ("size class", size_class, SIZES),
        ("wrist", wrist, WRISTS),
    ):
        _check(what, name, known)
    known_effects = effects_of(maker)
    for kind in kinds:
        _check("effect", kind, known_effects)
    spec = CaseSpec(
        maker=maker,
        seed=seed,
        arm=arm,
        wrist=wrist,
        kinds=kinds,
        size_class=size_class,
        number=number,
    )
    return case_of(spec)


def case_of(spec: CaseSpec) -> Case:
    """Close the case of a specification whose names are right (`make_case` checks them)."""
    return Case(spec, _part(spec.maker, "maker").made(arm_table(spec.arm), spec))


def effects_of(maker: str, version: int | None = None) -> tuple[str, ...]:
    """Return the effects that a maker can hide, one a module of its folder.

    Parameters
    ----------
    version
        Of the maker's library: a module that came later tells so by its `SINCE`. All when omitted.

    Raises
    ------
    PlantError
        If there is no such maker, or a package it needs is not installed.
    """
    modules = _part(maker, "maker").EFFECTS
    return tuple(
        name
        for name, module in modules.items()
        if version is None or getattr(module, "SINCE", 1) <= version
    )


def newest_version(maker: str) -> int:
    """Return the version of a maker's library that has all of its effects."""
    return max(getattr(module, "SINCE", 1) for module in _part(maker, "maker").EFFECTS.values())


def arms_of(maker: str, effect: str) -> tuple[str, ...]:
    """Return the arms in which a maker's effect has a place."""
    arms: tuple[str, ...] = getattr(_part(maker, "maker").EFFECTS[effect], "ARMS", ARMS)
    return arms


def wrists_of(maker: str, effect: str) -> tuple[str, ...]:
    """Return the wrists an arm may have for a maker's effect to have a place in it."""
    only = getattr(_part(maker, "maker").EFFECTS[effect], "WRIST", None)
    return WRISTS if only is None else (only,)


def _part(maker: str, name: str) -> Any:
    _check("maker", maker, MAKERS)
    needed = _NEEDS.get(maker)
    if needed is not None and util.find_spec(needed) is None:
        raise PlantError(
            f"maker {maker!r} needs the package {needed}, which is not installed; install "
            "armodal[makers]"
        )
    return import_module(f"armodal.hil_sim.makers.{maker}.{name}")


def _check(what: str, name: str, known: tuple[str, ...]) -> None:
    if name not in known:
        raise PlantError(f"no {what} is called {name!r}; wanted one of {', '.join(known)}")
