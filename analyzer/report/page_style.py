"""The style sheet of all pages."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

__all__ = ["style"]


@cache
def style() -> str:
    """Return it, for screen and print."""
    return files("armodal.analyzer.report").joinpath("style.css").read_text(encoding="utf-8")
