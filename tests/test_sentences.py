"""Sentences of the documents are short: 25 words on average at most, page by page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [
    page
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
    if "written" not in page.parts
]
MOST_WORDS = 25.0
# What is no sentence: code, equations, comments, tables, headings.
LEFT_OUT = (
    re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE),
    re.compile(r"\$\$.*?\$\$", re.DOTALL),
    re.compile(r"<!--.*?-->", re.DOTALL),
    re.compile(r"^[|#].*$", re.MULTILINE),
    re.compile(r"^    .*$", re.MULTILINE),
)
ITEM = re.compile(r"^\s*(?:[-*]|\d+\.)\s", re.MULTILINE)
SHORTENED = re.compile(r"\b([A-Z]|Eqs?|pp?|vs|ed|Int|Mech|Dyn|Syst|Meas|Proc|Trans|Fig|al)\.(?=\s)")
END = re.compile(r"(?<=[.!?])[\"*)]*\s+")


def lengths(text: str) -> list[int]:
    """Return the number of words of every sentence; what has fewer than three is a label."""
    for pattern in LEFT_OUT:
        text = pattern.sub("", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = SHORTENED.sub(r"\1", re.sub(r"`[^`]*`", "code", text))
    paragraphs = re.split(r"\n\s*\n", ITEM.sub("\n\n", text))
    sentences = [part for one in paragraphs for part in END.split(one)]
    counts = [sum(any(c.isalpha() for c in word) for word in part.split()) for part in sentences]
    return [count for count in counts if count >= 3]


def test_words_are_counted_by_sentence_without_code_and_tables():
    told = "One two three. See `a b` (Eq. 3) there!"
    text = f"# No sentence\n\n{told}\n\n| a | b c d e |\n\n- four five six"
    assert lengths(text) == [3, 4, 3]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_a_page_has_sentences_of_25_words_on_average_at_most(page):
    counts = lengths(page.read_text(encoding="utf-8"))
    assert not counts or sum(counts) / len(counts) <= MOST_WORDS
