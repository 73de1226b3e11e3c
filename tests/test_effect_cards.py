"""The site's card of every effect says what tells it, and has its picture."""

import sys
from pathlib import Path

import pytest

EXTENSIONS = Path(__file__).parents[1] / "docs" / "_ext"


@pytest.fixture(scope="module")
def pages():
    sys.path.insert(0, str(EXTENSIONS))
    try:
        from cards import effect_pages  # noqa: PLC0415 - beside the site's configuration

        return effect_pages()
    finally:
        sys.path.remove(str(EXTENSIONS))


@pytest.mark.long
def test_every_card_has_a_picture_a_signature_and_what_it_is_confused_with(pages):
    cards = {name: text for name, text in pages.items() if name.endswith(".md")}
    del cards["effects/index.md"]
    assert len(cards) > 20
    lacks = {
        (name, what)
        for name, text in cards.items()
        for what in ("Signature in the measurement", "Confused with", ".svg)")
        if what not in text
    }
    assert lacks == set()
