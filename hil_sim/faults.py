"""Faults the laboratory can be told to have, each a name and nothing more."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

from protocols.errors import PlantError

__all__ = ["Fault", "FaultSet"]


class Fault(StrEnum):
    """What can be made to go wrong."""

    BOARD_GARBAGE = "board-garbage"  # every frame of the board becomes random bytes
    BOARD_SILENCE = "board-silence"  # the board sends nothing
    DICTIONARY_CHANGE = "dictionary-change"  # a sensor's supply opens: the dictionary changes
    BLOCK_LOSS = "block-loss"  # every seventh BLOCK_DATA frame is lost on the link
    ADC_GAP = "adc-gap"  # the converter loses 100 samples, once each time it is switched on
    CAN_SILENCE = "can-silence"  # the controller sends no frames


class FaultSet:
    """The faults that are active at present.

    >>> faults = FaultSet(["can-silence"])
    >>> Fault.CAN_SILENCE in faults
    True
    """

    def __init__(self, names: Iterable[str] = ()) -> None:
        self._active: set[Fault] = set()
        for name in names:
            self.switch(name, active=True)

    def __contains__(self, fault: Fault) -> bool:
        return fault in self._active

    def switch(self, name: str, *, active: bool) -> None:
        """Switch a fault on or off.

        Raises
        ------
        PlantError
            If there is no fault of this name.
        """
        try:
            fault = Fault(name)
        except ValueError:
            known = ", ".join(Fault)
            raise PlantError(
                f"wanted a fault the laboratory knows ({known}), got {name!r}"
            ) from None
        if active:
            self._active.add(fault)
        else:
            self._active.discard(fault)

    def take(self, fault: Fault) -> bool:
        """Return whether a fault is active, and switch it off: for faults that happen once."""
        if fault not in self._active:
            return False
        self._active.remove(fault)
        return True
