"""What the controller says of its joints, a cycle at a time, as lines of an slcan adapter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cantools.database.can

from armodal.protocols.arm.records import CanMapping
from armodal.protocols.can_records import CLASSIC_BYTES
from armodal.protocols.errors import PlantError
from armodal.protocols.slcan import encode_slcan

__all__ = ["HELD", "MOVING", "JointMessages"]

HELD, MOVING = 2, 3  # DRIVE_STATE of armodal's own messages


@dataclass(frozen=True, slots=True)
class _Position:
    """raw = rate * q + zero."""

    joint: int
    signal: str
    rate: float
    zero: float


@dataclass(frozen=True, slots=True)
class _Sent:
    message: cantools.database.can.Message
    positions: tuple[_Position, ...]
    blank: dict[str, int]
    state: str | None
    counter: str | None
    modulus: int


class JointMessages:
    """Lines of one cycle, as the arm's mapping has them.

    Parameters
    ----------
    mapping
        Messages, signals, scales, signs and zeros; the bus's rates.
    joints
        Names, base outwards.

    Raises
    ------
    PlantError
        If the mapping leaves a joint out, its drive state has no value for a moving arm, or a
        message needs CAN FD, which an slcan adapter does not carry.
    """

    def __init__(self, mapping: CanMapping, joints: Sequence[str]) -> None:
        database = cantools.database.can.Database()
        database.add_dbc_string(mapping.database_text)
        mapped = {signal.joint for signal in mapping.joints}
        if missing := [name for name in joints if name not in mapped]:
            raise PlantError(
                f"the CAN section: wanted a signal for every joint, got none for "
                f"{', '.join(missing)}; add them to the arm file"
            )
        self.bitrate, self.rate_hz = mapping.bitrate, mapping.rate_hz
        self._held, self._moving = _states(mapping)
        state = mapping.drive_state.signal if mapping.drive_state else None
        counter = mapping.counter[1] if mapping.counter else None
        also = [mapping.drive_state.message] if mapping.drive_state else []
        also += [mapping.counter[0]] if mapping.counter else []
        names = dict.fromkeys([*(signal.message for signal in mapping.joints), *also])
        self._sent: list[_Sent] = []
        for name in names:
            message = database.get_message_by_name(name)
            if message.length > CLASSIC_BYTES:
                raise PlantError(
                    f"the CAN section: wanted messages of at most {CLASSIC_BYTES} bytes, which the "
                    f"simulated adapter carries, got {message.length} of {name}; to rehearse, take "
                    "a copy of the arm file without its [can] section"
                )
            signals = {signal.name: signal for signal in message.signals}
            positions = []
            for own in mapping.joints:
                if own.message == name and own.joint in joints:
                    signal = signals[own.signal]
                    scale = float(signal.scale)
                    rate = own.sign / (own.scale_rad * scale)
                    zero = -rate * own.offset_rad - float(signal.offset) / scale
                    positions.append(_Position(joints.index(own.joint), own.signal, rate, zero))
            self._sent.append(
                _Sent(
                    message=message,
                    positions=tuple(positions),
                    blank=dict.fromkeys(signals, 0),
                    state=state if state in signals else None,
                    counter=counter if counter in signals else None,
                    modulus=1 << signals[counter].length if counter in signals else 1,
                )
            )

    @property
    def per_cycle(self) -> int:
        """Frames a cycle."""
        return len(self._sent)

    def lines(self, joints_rad: Sequence[float], *, moving: bool, counter: int) -> bytes:
        """Return the slcan lines of one cycle."""
        lines = []
        for sent in self._sent:
            raw = dict(sent.blank)
            for at in sent.positions:
                raw[at.signal] = round(at.rate * joints_rad[at.joint] + at.zero)
            if sent.state is not None:
                raw[sent.state] = self._moving if moving else self._held
            if sent.counter is not None:
                raw[sent.counter] = counter % sent.modulus
            data = sent.message.encode(raw, scaling=False, strict=False)
            lines.append(
                encode_slcan(sent.message.frame_id, data, extended=sent.message.is_extended_frame)
            )
        return b"".join(lines)


def _states(mapping: CanMapping) -> tuple[int, int]:
    """Values of the drive state while the arm is held, and while it moves."""
    if mapping.drive_state is None:
        return HELD, MOVING
    held = mapping.drive_state.held_values
    return held[0], next(value for value in (MOVING, 0, 1, 2) if value not in held)
