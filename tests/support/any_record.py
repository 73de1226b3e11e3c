"""Any record of the board protocol that keeps the rules of its fields, from its layout."""

from enum import IntFlag
from fractions import Fraction

from hypothesis import strategies as st

from armodal.protocols.board.layout import layout_of


def values(field):
    """Values that a field may have."""
    numbers = st.integers(field.wire.low, field.wire.high)
    if field.members:
        return st.sampled_from(field.members)
    if issubclass(field.python, IntFlag):
        return st.integers(0, sum(field.python)).map(field.python)
    if field.python is bool:
        return st.booleans()
    if field.python is Fraction:
        return st.builds(Fraction, numbers, numbers)
    return numbers


def records(record):
    """Records of a type; most of an odd rule are made, the others filtered out."""
    layout = layout_of(record)
    made = st.builds(record, **{f.name: values(f) for f in layout.fields if f.is_stored})
    return made.filter(lambda m: all(rule.holds(m) for rule in layout.rules))
