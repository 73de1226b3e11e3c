"""What Markdown lacks: links to pages named as files, indices, whole numbers, wide cells."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from sphinx.addnodes import desc_signature, pending_xref
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform
from sphinx.transforms.post_transforms import SphinxPostTransform

_PAGE = re.compile(r"(?:docs/)?([\w./-]+)\.md")
_UNIT = r"(?:%|[kMGmµ]?Hz|[kMGm]?B|[kM]iB|[mµk]?m|[mµ]?s|N|kg|nats)(?![\w-])"
# A space that must not end a line, and a hyphen that must not: 3 %, ± 2, 1e-6, 2026-11-27.
_SPACE = re.compile(rf"(?<=\d) (?={_UNIT})|(?<=[±≤≥≈<>]) (?=[\u2212+\d])")
_PIECES = re.compile(
    r"(?P<whole>\b\d+(?:\.\d+)?e-\d+\b|\b\d{4}-\d\d-\d\d\b)"
    r"|(?P<of>(?<![A-Za-z_])[A-Za-z\u0391-\u03c9]|[\u1d34\u1d40])_"  # H and T raised, too
    r"(?!(?:axis|axes|channels|samples|hits|freq|std)\b|std_)"  # names, not symbols
    r"(?P<below>\([^()]*\)|[0-9a-z]+|[A-Z]{2,}|[A-Z\u0391-\u03c9])(?!_)"
    r"|\^(?P<above>\([^()]*\)|\{[^{}]*\}|[0-9]+(?:\.[0-9]+)?|[½¼¾]|\w+)"
)
_AS_IT_IS = (nodes.literal, nodes.math, nodes.FixedTextElement, nodes.raw)
_SHORT = 22  # characters of a word of code that is never broken, as at the hyphens of an option
_WIDE = 40  # characters of a cell that is read as a sentence


class PageLinks(SphinxTransform):
    """A page that is named by its file in code is a link to it."""

    default_priority = 400

    def apply(self, **_: Any) -> None:
        """Lay a reference around each such name."""
        for literal in list(self.document.findall(nodes.literal)):
            named = _PAGE.fullmatch(literal.astext())
            if named is None or isinstance(literal.parent, (nodes.reference, pending_xref)):
                continue
            folder = self.env.docname.rpartition("/")[0]
            for name in (f"{folder}/{named[1]}".lstrip("/"), named[1]):
                if name in self.env.found_docs and name != self.env.docname:
                    target = self.app.builder.get_relative_uri(self.env.docname, name)
                    link = nodes.reference("", "", literal.deepcopy(), internal=True, refuri=target)
                    literal.parent.replace(literal, link)
                    break


class Typography(SphinxPostTransform):
    """Indices and powers are set as such, numbers keep their units on their line.

    Long cells are marked, so that they can be given room.
    """

    default_priority = 900
    formats = ("html",)

    def run(self, **_: Any) -> None:
        """Change the words outside of code and equations."""
        for text in list(self.document.findall(nodes.Text)):
            if isinstance(text.parent, _AS_IT_IS) or _within(text, desc_signature):
                continue
            pieces = list(pieces_of(_SPACE.sub("\u00a0", text.astext())))
            if len(pieces) > 1 or pieces[0].astext() != text.astext():
                text.parent.replace(text, pieces)
        for literal in self.document.findall(nodes.literal):
            if max(map(len, literal.astext().split()), default=0) <= _SHORT:
                literal["classes"].append("short")
        for entry in self.document.findall(nodes.entry):
            if len(entry.astext()) > _WIDE:
                entry["classes"].append("wide")


def _within(node: nodes.Node, kind: type[nodes.Element]) -> bool:
    while node.parent is not None:
        node = node.parent
        if isinstance(node, kind):
            return True
    return False


def pieces_of(words: str) -> Iterator[nodes.Node]:
    """Words as nodes: what stands below or above the line, and what must not be broken."""
    at = 0
    for found in _PIECES.finditer(words):
        yield nodes.Text(words[at : found.start()] + (found["of"] or ""))
        if found["whole"]:
            yield nodes.inline("", found[0], classes=["whole"])
        elif found["below"]:
            yield nodes.subscript("", found["below"].strip("()"))
        else:
            yield nodes.superscript("", found["above"].strip("(){}"))
        at = found.end()
    yield nodes.Text(words[at:])


def setup(app: Sphinx) -> dict[str, bool]:
    """Register both with Sphinx."""
    app.add_transform(PageLinks)
    app.add_post_transform(Typography)
    return {"parallel_read_safe": True}
