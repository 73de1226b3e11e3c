"""Text from files is shown so that it steers nothing."""

from __future__ import annotations

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from armodal.protocols.printable import printable

TURNING = {"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"}


def is_unseen(sign: str) -> bool:
    """By Unicode's own tables: controls, surrogates, line separators, what turns a line."""
    kind = unicodedata.category(sign)
    turns = unicodedata.bidirectional(sign) in TURNING or sign in "\u061c\u200e\u200f"
    return kind in {"Cc", "Cs", "Zl", "Zp"} or turns


@pytest.mark.parametrize(
    "codes",
    [range(0x10000), pytest.param(range(0x10000, 0x110000), marks=pytest.mark.long)],
)
def test_every_unseen_character_of_unicode_is_written_out(codes):
    kept = {"\n", "\t"}
    for code in codes:
        sign = chr(code)
        assert (printable(sign) != sign) == (is_unseen(sign) and sign not in kept), hex(code)


@given(st.text(st.characters(categories=None)))
def test_what_is_printable_stays_so(text):
    shown = printable(text)
    assert not any(is_unseen(sign) for sign in shown if sign not in "\n\t")
    assert printable(shown) == shown
    shown.encode()


@pytest.mark.parametrize("text", ["Gelenk Nº 1", "試験 1", "عربي", "a\tb\nc", "🔧"])
def test_words_of_any_language_are_shown_as_they_are(text):
    assert printable(text) == text
