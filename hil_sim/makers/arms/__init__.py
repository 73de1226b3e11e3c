"""Tables of arms, one a module, found by their module's name."""

from collections.abc import Callable

from armodal.hil_sim.makers.arm_table import ArmTable
from armodal.hil_sim.makers.listing import modules_of

__all__ = ["ARMS", "WRISTS", "arm_table", "arms_with"]

WRISTS = ("elastic", "rigid")
_TABLES: dict[str, ArmTable] = {
    module.TABLE.name: module.TABLE for module in modules_of(__name__, __path__).values()
}
ARMS = tuple(_TABLES)


def arm_table(name: str) -> ArmTable:
    """Return the table of an arm.

    Raises
    ------
    KeyError
        If no module has an arm of that name.
    """
    return _TABLES[name]


def arms_with(links: Callable[[ArmTable], tuple[str, ...]]) -> tuple[str, ...]:
    """Return the arms that have such links."""
    return tuple(name for name, table in _TABLES.items() if links(table))
