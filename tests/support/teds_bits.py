"""Data sheets of sensors, bit by bit."""

import math
from datetime import date


def bits(*fields):
    """Bytes of (number, bits), the first field in the lowest bits."""
    value = at = 0
    for number, n in fields:
        assert 0 <= number < 1 << n
        value |= number << at
        at += n
    return value.to_bytes(math.ceil(at / 8), "little")


def basic(*, maker=31, model=393, letter=2, number=3, serial=54_321):
    return [(maker, 14), (model, 15), (letter, 5), (number, 6), (serial, 24)]


def steps(value, start, tolerance):
    """The number that stands for a value of constant relative resolution."""
    return round(math.log(value / start) / math.log(1.0 + 2.0 * tolerance))


def iepe(sensitivity_v, *, is_force=False, calibrated=None, transfer=False, sign=0, **who):
    """A whole data sheet by template 25, without extended functionality."""
    days = 0xFFFF if calibrated is None else (calibrated - date(1998, 1, 1)).days
    fields = [*basic(**who), (0, 2), (25, 8), (int(is_force), 1), (0, 1)]
    fields += [(steps(sensitivity_v, 5e-7, 1.5e-4), 16), (67, 8)]
    if not is_force:
        fields += [(1, 2), (21, 6), (sign, 1), (int(transfer), 1)]
        fields += [(0x15_5555_5555, 38)] if transfer else []
        fields += [(111, 8), (17, 5), (days, 16)]
    return bits(*fields, (0, 15), (0, 12), (0, 11), (2, 2), (0, 1))
