"""Equations as MathML, which browsers draw themselves: a page needs no script and no network."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx

_UNKNOWN = re.compile(r"<m[ion]>\\[a-zA-Z]+</m[ion]>")


def _mathml(source: str, display: str) -> str:
    """Return an equation as MathML, and refuse one with a command that the converter lacks."""
    text: str = convert(source, display=display)
    lacks = _UNKNOWN.findall(text)
    if lacks:
        raise ValueError(f"equation {source}: MathML lacks {', '.join(lacks)}")
    return text


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(_mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def _display(translator: Any, node: nodes.math_block) -> None:
    translator.body.append(f'<div class="math">{_mathml(node.astext(), "block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer with Sphinx."""
    app.add_html_math_renderer(
        "mathml", inline_renderers=(_inline, None), block_renderers=(_display, None)
    )
    app.config.html_math_renderer = "mathml"  # type: ignore[attr-defined]
    return {"parallel_read_safe": True}
