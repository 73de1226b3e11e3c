"""Decode the controller's CAN frames into joint angles, by the DBC file the arm names.

Nothing here reads a clock: whoever feeds the frames keeps their times and ages.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from armodal.protocols.arm.records import CanMapping, JointSignal
from armodal.protocols.can_records import CLASSIC_BYTES, CanFrame, bytes_carried
from armodal.protocols.errors import CanError

if TYPE_CHECKING:
    from cantools.database.can import Database, Message

__all__ = [
    "DBC_DIRECTORY",
    "CanDecoder",
    "CanEncoder",
    "CanFrame",
    "CanUpdate",
    "load_database",
    "mapped_message",
]

DBC_DIRECTORY = Path(__file__).parent / "dbc"


_MESSAGE_LENGTH = re.compile(r"\bBO_\s+\d+\s+\w+\s*:\s*(\d+)")
_LONGEST_MESSAGE = 64
_SIGNAL_BITS = re.compile(r":\s*[-+]?(\d+)\s*\|\s*[-+]?(\d+)\s*@")
_LONGEST_SIGNAL = 64  # bits


@dataclass(frozen=True, slots=True, kw_only=True)
class CanUpdate:
    """What one mapped frame says.

    `joints_rad` is empty for a frame that repeats the counter of the one before: a controller
    that has stopped must become stale, and a frame received twice tells nothing. `drive_state`
    is that of the first message, in the mapping's order, that last said other than held, else
    this frame's. `held` needs every mapped message that carries the state to have said so.
    """

    message: str
    joints_rad: dict[str, float]
    drive_state: int | None  # None where the mapping has none, or none was heard
    held: bool | None  # None where the mapping has no drive state
    counter: int | None
    lost: int  # frames of this message skipped since the one before, by its counter
    repeated: bool
    signals: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class _MappedMessage:
    definition: Message
    joints: tuple[JointSignal, ...]
    state: str | None
    counter: str | None
    counter_modulus: int


class CanDecoder:
    """Turn frames into joint angles.

    The drive state and the counter are looked for by the mapping's signal name in every message
    that carries a joint or is named for them, so that each message can be checked by itself.

    Raises
    ------
    CanError
        If the database cannot be read or lacks a mapped message or signal.
    """

    def __init__(self, mapping: CanMapping) -> None:
        self._held_values = mapping.drive_state.held_values if mapping.drive_state else ()
        self._messages = _mapped_messages(mapping)
        self._counters: dict[str, int] = {}
        self._states: dict[str, int] = {}

    def decode(self, frame: CanFrame) -> CanUpdate | None:
        """Decode one frame; None for a frame the mapping does not name, or a remote frame.

        Raises
        ------
        CanError
            If the frame's length is not the database's, or a value is outside its range there
            (as the controller says "not available"). The decoder's state is then unchanged.
        """
        mapped = self._messages.get((frame.can_id, frame.extended))
        if mapped is None or frame.remote:
            return None
        definition = mapped.definition
        signals = _decode_signals(definition, frame)
        name = definition.name
        counter, lost, repeated = self._count(name, mapped, signals)
        if mapped.state is not None:
            self._states[name] = int(signals[mapped.state])
        state, held = self._drive(mapped)
        joints = {
            joint.joint: joint.sign * joint.scale_rad * signals[joint.signal] + joint.offset_rad
            for joint in mapped.joints
        }
        return CanUpdate(
            message=name,
            joints_rad={} if repeated else joints,
            drive_state=state,
            held=held,
            counter=counter,
            lost=lost,
            repeated=repeated,
            signals=signals,
        )

    def _count(
        self, name: str, mapped: _MappedMessage, signals: Mapping[str, float]
    ) -> tuple[int | None, int, bool]:
        if mapped.counter is None:
            return None, 0, False
        counter = int(signals[mapped.counter])
        before = self._counters.get(name)
        self._counters[name] = counter
        if before is None:
            return counter, 0, False
        step = (counter - before) % mapped.counter_modulus
        return counter, max(step - 1, 0), step == 0

    def _drive(self, mapped: _MappedMessage) -> tuple[int | None, bool | None]:
        carriers = [m.definition.name for m in self._messages.values() if m.state is not None]
        if not carriers:
            return None, None
        for name in carriers:
            if name in self._states and self._states[name] not in self._held_values:
                return self._states[name], False
        return self._states.get(mapped.definition.name), all(n in self._states for n in carriers)


class CanEncoder:
    """Compose the frames of one cycle; for simulated controllers, since we never write."""

    def __init__(self, mapping: CanMapping) -> None:
        self._messages = _mapped_messages(mapping)

    def encode(
        self, joints_rad: Mapping[str, float], *, drive_state: int, counter: int
    ) -> tuple[CanFrame, ...]:
        """Return one frame for each mapped message, in the mapping's order.

        Raises
        ------
        CanError
            If an angle is missing or does not fit its signal.
        """
        frames = []
        for (can_id, extended), mapped in self._messages.items():
            values = {signal.name: 0.0 for signal in mapped.definition.signals}
            for joint in mapped.joints:
                if joint.joint not in joints_rad:
                    raise CanError(f"wanted an angle of {joint.joint}, got none")
                offset_free = joints_rad[joint.joint] - joint.offset_rad
                values[joint.signal] = joint.sign * offset_free / joint.scale_rad
            if mapped.state is not None:
                values[mapped.state] = drive_state
            if mapped.counter is not None:
                values[mapped.counter] = counter % mapped.counter_modulus
            try:
                data = mapped.definition.encode(values)
            except _parser_errors() as problem:
                raise CanError(
                    f"{mapped.definition.name} cannot be encoded: {problem}"
                ) from problem
            fd = len(data) > CLASSIC_BYTES
            data = bytes(data).ljust(bytes_carried(len(data), fd=fd), b"\0")
            frames.append(CanFrame(can_id=can_id, extended=extended, data=data, fd=fd))
        return tuple(frames)


def fd_messages(mapping: CanMapping) -> tuple[str, ...]:
    """Mapped messages that only a CAN FD frame can carry, since they are longer than 8 bytes.

    Raises
    ------
    CanError
        If the database cannot be read or lacks a mapped message or signal.
    """
    definitions = [mapped.definition for mapped in _mapped_messages(mapping).values()]
    return tuple(each.name for each in definitions if each.length > CLASSIC_BYTES)


def load_database(text: str, name: str) -> Database:
    """Parse the text of a DBC file, or raise CanError with its name."""
    for found in _MESSAGE_LENGTH.finditer(text):
        # The parser lays out every bit of a message, so that a huge one would take the memory.
        if len(found[1]) > 2 or int(found[1]) > _LONGEST_MESSAGE:
            raise CanError(
                f"CAN database {name}: wanted messages of at most {_LONGEST_MESSAGE} bytes, "
                f"got {found[1][:12]}"
            )
    for found in _SIGNAL_BITS.finditer(text):
        if max(len(found[1]), len(found[2])) > 3 or int(found[2]) > _LONGEST_SIGNAL:
            raise CanError(
                f"CAN database {name}: wanted signals of at most {_LONGEST_SIGNAL} bits below bit "
                f"1000, got {found[1][:12]}|{found[2][:12]}"
            )
    cantools = import_module("cantools")
    try:
        database = _parsed(text)
    except _parser_errors() as problem:
        raise CanError(f"CAN database {name}: wanted a DBC file, got: {problem}") from problem
    if not isinstance(database, cantools.database.can.Database):
        raise CanError(f"CAN database {name}: wanted a DBC file, got another kind of database")
    found_one: Database = database
    return found_one


@lru_cache(maxsize=4)  # of a session's arm: asked for by each who reads or checks its frames
def _parsed(text: str) -> Any:
    return import_module("cantools").database.load_string(text, database_format="dbc", strict=True)


def _parser_errors() -> tuple[type[Exception], ...]:
    """A DBC file comes from elsewhere: whatever its parser trips over is the file's fault."""
    return (
        import_module("cantools").Error,
        ValueError,
        LookupError,
        TypeError,
        AttributeError,
        ArithmeticError,
        RecursionError,
    )


def mapped_message(
    database: Database, message: str, signal: str, *, number: bool = False
) -> Message:
    """Return the message, having checked that it carries the signal in a form we can decode.

    Parameters
    ----------
    number
        True for a counter or a state, which must be a plain unsigned number.

    Raises
    ------
    CanError
        If either is absent, or the message is multiplexed, or a container, or the
        signal is no plain number where one is wanted.
    """
    known = {m.name: m for m in database.messages}
    if message not in known:
        raise CanError(f"wanted a message of the database ({_listed(known)}), got {message!r}")
    definition = known[message]
    if definition.is_multiplexed() or definition.is_container:
        raise CanError(f"wanted a plain message, got {message!r}, which is not")
    signals = {s.name: s for s in definition.signals}
    if signal not in signals:
        raise CanError(f"wanted a signal of {message} ({_listed(signals)}), got {signal!r}")
    found = signals[signal]
    plain = found.scale == 1 and found.offset == 0 and not (found.is_signed or found.is_float)
    if number and not (plain and found.length <= 32):
        raise CanError(f"wanted {message}.{signal} unsigned and unscaled, of at most 32 bits")
    scale = float(found.scale)
    if not math.isfinite(scale) or scale == 0.0:
        raise CanError(f"wanted a finite scale of {message}.{signal}, not zero, got {scale}")
    return definition


def _mapped_messages(mapping: CanMapping) -> dict[tuple[int, bool], _MappedMessage]:
    database = load_database(mapping.database_text, mapping.database)
    wanted = [(joint.message, joint.signal, False) for joint in mapping.joints]
    if mapping.drive_state is not None:
        wanted.append((mapping.drive_state.message, mapping.drive_state.signal, True))
    if mapping.counter is not None:
        wanted.append((*mapping.counter, True))
    messages: dict[tuple[int, bool], _MappedMessage] = {}
    for message, signal, number in wanted:
        definition = mapped_message(database, message, signal, number=number)
        signals = {s.name: s for s in definition.signals}
        state = mapping.drive_state.signal if mapping.drive_state is not None else None
        counter = mapping.counter[1] if mapping.counter is not None else None
        for name in (state, counter):
            if name is not None and name in signals:
                mapped_message(database, message, name, number=True)
        messages[definition.frame_id, definition.is_extended_frame] = _MappedMessage(
            definition=definition,
            joints=tuple(joint for joint in mapping.joints if joint.message == message),
            state=state if state in signals else None,
            counter=counter if counter in signals else None,
            counter_modulus=2 ** signals[counter].length if counter in signals else 1,
        )
    return messages


def _decode_signals(definition: Message, frame: CanFrame) -> dict[str, float]:
    carried = bytes_carried(definition.length, fd=frame.fd)
    if len(frame.data) != carried:
        raise CanError(f"{definition.name}: wanted {carried} bytes, got {len(frame.data)}")
    try:
        decoded = definition.decode(frame.data[: definition.length], decode_choices=False)
    except _parser_errors() as problem:
        raise CanError(f"{definition.name} cannot be decoded: {problem}") from problem
    if not isinstance(decoded, dict):
        raise CanError(f"{definition.name}: wanted a plain message, got a container")
    values = {name: float(v) for name, v in decoded.items() if isinstance(v, int | float)}
    for signal in definition.signals:
        # Half a count, so that a limit printed in decimals is itself inside.
        half = 0.5 * abs(float(signal.scale))
        low = -math.inf if signal.minimum is None else float(signal.minimum) - half
        high = math.inf if signal.maximum is None else float(signal.maximum) + half
        value = values[signal.name]
        if not (math.isfinite(value) and low <= value <= high):
            raise CanError(
                f"{definition.name}.{signal.name}: wanted {signal.minimum} to {signal.maximum}, "
                f"got {value}: the controller says it is not available"
            )
    return values


def _listed(names: Mapping[str, object]) -> str:
    return ", ".join(list(names)[:12]) + (", ..." if len(names) > 12 else "")
