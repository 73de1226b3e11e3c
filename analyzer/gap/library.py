"""Every effect the workflow knows: a module of `analyzer.gap.effects` with `instances` is one."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from functools import lru_cache

from armodal.analyzer.gap import effects
from armodal.analyzer.gap.effects.effect import Instance
from armodal.analyzer.gap.ordinary import Ordinary

__all__ = ["all_instances"]


@lru_cache(maxsize=8)  # of an arm and its postures; asked for in every round
def all_instances(ordinary: Ordinary) -> tuple[Instance, ...]:
    """Return every effect at every place of an arm where it may be."""
    found: list[Instance] = []
    for module in pkgutil.iter_modules(effects.__path__):
        code = importlib.import_module(f"{effects.__name__}.{module.name}")
        make: Callable[[Ordinary], tuple[Instance, ...]] | None = getattr(code, "instances", None)
        if make is not None:
            found += make(ordinary)
    return tuple(found)
