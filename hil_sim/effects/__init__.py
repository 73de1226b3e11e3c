"""What a plant file can hide in the arm or its measurement; `docs/simulated-plant.md` lists it.

Every table's class in a module of this folder is found by itself.
"""

from functools import reduce
from importlib import import_module
from operator import or_
from pkgutil import iter_modules
from types import ModuleType
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from armodal.hil_sim.effects.effect import BaseEffect

__all__ = ["BaseEffect", "Effect", "modules_with"]

_MODULES = {
    found.name: import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__)
}
_TABLES = [
    table
    for name, module in sorted(_MODULES.items())
    for table in vars(module).values()
    if isinstance(table, type)
    and issubclass(table, BaseEffect)
    and table.__module__ == module.__name__
    and "kind" in table.model_fields
]

if TYPE_CHECKING:
    Effect = BaseEffect
else:
    Effect = Annotated[reduce(or_, _TABLES), Field(discriminator="kind")]


def modules_with(name: str) -> dict[str, ModuleType]:
    """Return the modules of this folder that offer something of that name, by their own name."""
    return {own: module for own, module in sorted(_MODULES.items()) if hasattr(module, name)}
