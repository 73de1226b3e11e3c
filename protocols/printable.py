"""Text from files as it may be shown: what steers a terminal or turns a line is written out."""

from __future__ import annotations

import re

__all__ = ["UNSEEN", "printable"]

# C0 and C1 controls, and those that turn or break a line (Unicode UAX 9: bidirectional marks,
# embeddings, overrides, isolates). As a class of characters in a regular expression.
UNSEEN = r"\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"
_NOT_SHOWN = re.compile(rf"[{UNSEEN}\ud800-\udfff]")


def printable(text: str, *, keep: str = "\n\t") -> str:
    r"""Return `text` with every character that is not seen as Python writes it.

    Those of `keep` stay: where lines are wanted, line ends and tabs.

    >>> print(printable("test \x9b2J \u202e1"))
    test \x9b2J \u202e1
    """
    if text.isprintable():  # nearly always, and told at once
        return text
    return _NOT_SHOWN.sub(
        lambda found: found.group() if found.group() in keep else ascii(found.group())[1:-1], text
    )
