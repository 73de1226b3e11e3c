"""Electronic data sheets of sensors (TEDS, IEEE 1451.4): who it is, and how sensitive.

The bits of a data sheet, the least significant of every byte first:

    basic TEDS, 64 bits     manufacturer 14, model 15, version letter 5, version number 6, serial 24
    selector, 2 bits        0: a template of the standard follows
    template, 8 bits        25: accelerometer or force transducer with a constant-current supply
    template 25             0 acceleration, 1 force; extended functionality; sensitivity 16; high
                            pass 8; of an accelerometer then direction 2, weight 6, sign 1, transfer
                            function 1 (and 38 bits of it), reference frequency 8, temperature 5,
                            date of calibration 16

A number of constant relative resolution is start * (1 + 2 * tolerance)^n.

References
----------
IEEE 1451.4-2004. National Instruments, An Overview of IEEE 1451.4 Transducer Electronic Data
Sheets, tables 1 (basic TEDS) and 25 (accelerometer and force), and its data types.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date, timedelta

from armodal.protocols.board.records import Channel
from armodal.protocols.errors import FrameError

__all__ = ["SensorTeds", "contradictions", "decode_teds"]

BASIC_BYTES = 8
MAKERS = range(17, 16_382)  # numbers of manufacturers; others have special uses
TEMPLATE_IEPE = 25
SENSITIVITY = (5e-7, 1.5e-4)  # V per m/s^2 or N: start, tolerance
HIGHPASS_HZ = (5e-3, 3e-2)
FIRST_DAY = date(1998, 1, 1)
TRANSFER_FUNCTION_BITS = 38
NO_DATE = 0xFFFF
# A sensitivity is told to 0.015 %, twice, and people write three or four digits of it.
ALIKE = 2e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorTeds:
    """What a sensor says of itself; None where it does not, or not as known here.

    sensitivity_v : V per N or per m/s^2
    """

    manufacturer: int
    model: int
    version: str  # letter and number
    serial_number: int
    template: int | None
    quantity: str | None = None
    sensitivity_v: float | None = None
    highpass_hz: float | None = None
    calibrated: date | None = None


class _Bits:
    """Numbers of a data sheet, one after the other."""

    def __init__(self, data: bytes) -> None:
        self._value = int.from_bytes(data, "little")
        self._left = 8 * len(data)

    def take(self, n: int) -> int | None:
        """Return the next number of n bits; None behind the end."""
        if n > self._left:
            return None
        found = self._value & ((1 << n) - 1)
        self._value >>= n
        self._left -= n
        return found


def decode_teds(data: bytes) -> SensorTeds:
    """Read the bit stream of a data sheet, checksum bytes of the memory taken out.

    Raises
    ------
    FrameError
        If it is shorter than a basic TEDS.
    """
    if len(data) < BASIC_BYTES:
        raise FrameError(f"wanted a TEDS of {BASIC_BYTES} bytes or more, got {len(data)}")
    bits = _Bits(data)
    manufacturer, model, letter, number, serial = (bits.take(n) or 0 for n in (14, 15, 5, 6, 24))
    selector, template = bits.take(2), bits.take(8)
    if selector != 0 or not template:
        template = None
    told = _iepe(bits) if template == TEMPLATE_IEPE else {}
    return SensorTeds(
        manufacturer=manufacturer,
        model=model,
        version=f"{chr(ord('@') + letter) if 1 <= letter <= 26 else ''}{number}",
        serial_number=serial,
        template=template,
        **told,  # type: ignore[arg-type]
    )


def _iepe(bits: _Bits) -> dict[str, object]:
    """Template 25, as far as it is known here: not that of extended functionality."""
    is_force, extended = bits.take(1), bits.take(1)
    if is_force is None or extended != 0:
        return {}
    told: dict[str, object] = {"quantity": "force" if is_force else "acceleration"}
    sensitivity, highpass = bits.take(16), bits.take(8)
    if sensitivity is None or highpass is None:
        return told
    told["sensitivity_v"] = _relative(SENSITIVITY, sensitivity)
    told["highpass_hz"] = _relative(HIGHPASS_HZ, highpass)
    if is_force:
        return told  # what comes between this and the date is not known here
    sign = [bits.take(n) for n in (2, 6, 1)][-1]
    if sign:
        told["sensitivity_v"] = -_relative(SENSITIVITY, sensitivity)
    if bits.take(1):
        bits.take(TRANSFER_FUNCTION_BITS)
    days = [bits.take(n) for n in (8, 5, 16)][-1]
    if days and days != NO_DATE:
        told["calibrated"] = FIRST_DAY + timedelta(days=days)
    return told


def _relative(scale: tuple[float, float], n: int) -> float:
    start, tolerance = scale
    return float(start * (1.0 + 2.0 * tolerance) ** n)


def contradictions(channel: Channel, range_v: float | None = None) -> list[str]:
    """Sentences on what a channel's description and its sensor's own data sheet say differently.

    Parameters
    ----------
    channel
        As the board describes it, with the data sheet that the board has read.
    range_v
        Largest input voltage; without it a sensitivity cannot be compared.
    """
    if len(channel.teds) < BASIC_BYTES:
        return []
    told = decode_teds(channel.teds)
    if told.manufacturer not in MAKERS:
        return []  # nobody's: not of a sensor that was bought
    said = []
    digits = "".join(c for c in channel.serial_number if c.isdigit())
    if digits and int(digits) != told.serial_number:
        said.append(
            f"{channel.name}: the sensor says serial number {told.serial_number}, the board "
            f"{channel.serial_number}"
        )
    if told.quantity is not None and told.quantity != channel.quantity:
        said.append(
            f"{channel.name}: the sensor says {told.quantity}, the board {channel.quantity}"
        )
    elif told.sensitivity_v is not None and range_v is not None:
        by_board_v = range_v / channel.full_scale
        if abs(abs(told.sensitivity_v) / by_board_v - 1.0) > ALIKE:
            said.append(
                f"{channel.name}: the sensor says {1e3 * abs(told.sensitivity_v):.4g} mV per "
                f"{channel.unit}, the board {1e3 * by_board_v:.4g}"
            )
    day = channel.calibration_date
    if told.calibrated is not None and day and day != told.calibrated.isoformat():
        said.append(
            f"{channel.name}: the sensor says it was calibrated on {told.calibrated}, the board "
            f"{day}"
        )
    return said
