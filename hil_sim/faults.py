"""Faults the laboratory can be told to have: a name, and if wanted the samples they last for."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from armodal.protocols.errors import PlantError

__all__ = ["Fault", "FaultSet", "ScriptedFault"]


class Fault(StrEnum):
    """What can be made to go wrong."""

    # The line from the board: each of its frames is hit or missed by chance.
    BIT_FLIP = "bit-flip"  # one bit of a frame
    FRAME_DROP = "frame-drop"  # a frame is lost
    FRAME_DUPLICATE = "frame-duplicate"  # a frame comes twice
    FRAME_REORDER = "frame-reorder"  # a frame comes after the next one
    FRAME_TRUNCATE = "frame-truncate"  # a frame's end is lost
    BLOCK_LOSS = "block-loss"  # every seventh BLOCK_DATA frame is lost on the link
    LINK_STALL = "link-stall"  # bytes stay on the way and come later
    BOARD_GARBAGE = "board-garbage"  # every frame of the board becomes random bytes
    BOARD_SILENCE = "board-silence"  # the board sends nothing
    UNPLUG = "unplug"  # the board's line is gone
    # The board.
    DEVICE_OVERFLOW = "device-overflow"  # the link takes nothing, so the board's buffers overflow
    BOARD_REBOOT = "board-reboot"  # once: it begins anew, with another session
    DICTIONARY_CHANGE = "dictionary-change"  # a sensor's supply opens: the dictionary changes
    CLOCK_JUMP = "clock-jump"  # once: the ticks jump by up to five seconds either way
    CLOCK_DRIFT = "clock-drift"  # the ticks run 500 ppm faster
    # The converter; channels are drawn by lot.
    ADC_GAP = "adc-gap"  # once: the converter loses 100 samples
    CHANNEL_STUCK = "channel-stuck"  # a channel repeats one count
    CHANNEL_CLIPPED = "channel-clipped"  # a channel's amplifier saturates
    CHANNEL_GARBAGE = "channel-garbage"  # a channel holds random counts
    # The controller and its bus.
    CAN_SILENCE = "can-silence"  # the controller sends no frames
    CAN_CORRUPT = "can-corrupt"  # characters of the adapter's lines are wrong
    ARM_MOVES = "arm-moves"  # once: the arm moves three degrees away by itself
    ARM_TWITCHES = "arm-twitches"  # once: the arm moves two degrees away and back


@dataclass(frozen=True, slots=True, kw_only=True)
class ScriptedFault:
    """A fault from one sample index on, for a number of samples or for good (None)."""

    fault: Fault
    at_sample: int
    n_samples: int | None = None


_SCRIPT = re.compile(r"(?P<name>[^@]*)(?:@(?P<at>\d{1,15})(?:\+(?P<n>[1-9]\d{0,14}))?)?")


class FaultSet:
    """The faults that are active at present, and those to come.

    A fault is given by its name, which is active at once, or as NAME@SAMPLE or NAME@SAMPLE+COUNT:
    active when the board has taken so many samples since START, for so many samples. Each comes
    once, however often the board is started.

    >>> faults = FaultSet(["can-silence", "bit-flip@1000+64"])
    >>> Fault.CAN_SILENCE in faults, Fault.BIT_FLIP in faults
    (True, False)
    >>> faults.reach(1000)
    >>> Fault.BIT_FLIP in faults
    True
    >>> faults.reach(1064)
    >>> Fault.BIT_FLIP in faults
    False
    """

    def __init__(self, names: Iterable[str] = ()) -> None:
        self._active: set[Fault] = set()
        self._to_come: list[ScriptedFault] = []
        self._endings: list[tuple[int, Fault]] = []
        self._last_sample = 0
        self._taken = 0  # samples of all runs together, in which faults last
        for name in names:
            self.switch(name, active=True)

    def __contains__(self, fault: Fault) -> bool:
        return fault in self._active

    def switch(self, name: str, *, active: bool) -> None:
        """Switch a fault on or off, or put one in the script or out of it.

        Raises
        ------
        PlantError
            If there is no fault of this name.
        """
        scripted = _parse(name)
        fault = scripted.fault
        if "@" in name:
            if active:
                self._to_come.append(scripted)
            else:
                self._to_come = [s for s in self._to_come if s != scripted]
        elif active:
            self._active.add(fault)
        else:
            self._active.discard(fault)

    def reach(self, sample: int) -> None:
        """Tell how many samples have been taken since START: scripted faults begin and end."""
        started_anew = sample < self._last_sample
        self._taken += sample if started_anew else sample - self._last_sample
        self._last_sample = sample
        self._active.difference_update(fault for at, fault in self._endings if at <= self._taken)
        self._endings = [(at, fault) for at, fault in self._endings if at > self._taken]
        for scripted in [s for s in self._to_come if s.at_sample <= sample]:
            self._to_come.remove(scripted)
            self._active.add(scripted.fault)
            if scripted.n_samples is not None:
                self._endings.append((self._taken + scripted.n_samples, scripted.fault))

    def until_change(self, sample: int) -> int | None:
        """Return how many samples there are until the next scripted change; None where none is."""
        ahead = [s.at_sample - sample for s in self._to_come]
        ahead += [at - self._taken for at, _ in self._endings]
        return min((n for n in ahead if n > 0), default=None)

    def take(self, fault: Fault) -> bool:
        """Return whether a fault is active, and switch it off: for faults that happen once."""
        if fault not in self._active:
            return False
        self._active.remove(fault)
        return True


def _parse(text: str) -> ScriptedFault:
    parts = _SCRIPT.fullmatch(text)
    if parts is None or parts["name"] not in set(Fault):
        known = ", ".join(Fault)
        raise PlantError(
            f"wanted a fault the laboratory knows ({known}), or one of them as NAME@SAMPLE or "
            f"NAME@SAMPLE+COUNT, got {text!r}"
        )
    return ScriptedFault(
        fault=Fault(parts["name"]),
        at_sample=int(parts["at"] or 0),
        n_samples=int(parts["n"]) if parts["n"] else None,
    )
