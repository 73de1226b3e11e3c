"""Boards that break the protocol, each in one way: healthy frames, altered on the wire.

They serve to show that `armodal check board` finds what it looks for.
"""

from collections.abc import Callable

from armodal.hil_sim.broken_board.altered import BrokenBoard
from armodal.hil_sim.broken_board.blocks import (
    HalfCounted,
    LatePretrigger,
    LateTrigger,
    NoCounts,
    NoFlags,
    OtherResend,
    WrongSlope,
)
from armodal.hil_sim.broken_board.frames import (
    FastClock,
    HashLost,
    SilentSkip,
    SlowSamples,
    StuckSequence,
    TicksBackwards,
    TwiceSent,
    WrongCrc,
    WrongHash,
)
from armodal.hil_sim.broken_board.manners import (
    AnySession,
    CutsLongCommands,
    DeafToMalformed,
    DeafToOtherVersions,
    DeafToUnknown,
    DiesOnGarbage,
    ForgetsOnReconnect,
    NewSession,
    ObeysTornFrames,
    RefusesNothing,
    RefusesWithoutReason,
    ScaleInAnotherUnit,
)
from armodal.protocols.errors import PlantError

__all__ = ["BROKEN_BOARDS", "BrokenBoard", "broken_board"]

BROKEN_BOARDS: dict[str, Callable[[], BrokenBoard]] = {
    "none": BrokenBoard,
    "any-session": AnySession,
    "cuts-long-commands": CutsLongCommands,
    "deaf-to-malformed": DeafToMalformed,
    "deaf-to-other-versions": DeafToOtherVersions,
    "deaf-to-unknown": DeafToUnknown,
    "dies-on-garbage": DiesOnGarbage,
    "fast-clock": FastClock,
    "forgets-on-reconnect": ForgetsOnReconnect,
    "half-counted": HalfCounted,
    "hash-lost": HashLost,
    "late-pretrigger": LatePretrigger,
    "late-trigger": LateTrigger,
    "new-session": NewSession,
    "no-counts": NoCounts,
    "no-flags": NoFlags,
    "obeys-torn-frames": ObeysTornFrames,
    "other-resend": OtherResend,
    "refuses-nothing": RefusesNothing,
    "refuses-without-reason": RefusesWithoutReason,
    "scale-in-another-unit": ScaleInAnotherUnit,
    "silent-skip": SilentSkip,
    "slow-samples": SlowSamples,
    "stuck-sequence": StuckSequence,
    "ticks-backwards": TicksBackwards,
    "twice-sent": TwiceSent,
    "wrong-crc": WrongCrc,
    "wrong-hash": WrongHash,
    "wrong-slope": WrongSlope,
}


def broken_board(name: str) -> BrokenBoard:
    """Return the broken board of a name.

    Raises
    ------
    PlantError
        If there is none of this name.
    """
    if name not in BROKEN_BOARDS:
        known = ", ".join(BROKEN_BOARDS)
        raise PlantError(f"wanted a broken board there is ({known}), got {name!r}")
    return BROKEN_BOARDS[name]()
