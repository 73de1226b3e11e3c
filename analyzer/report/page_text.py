"""What pages are made with: templates and labels that show text from files and never run it."""

from __future__ import annotations

from functools import cache

import jinja2
from markupsafe import escape

from armodal.protocols.printable import printable

__all__ = ["shown", "templates"]


@cache
def templates() -> jinja2.Environment:
    """Return the report's templates; what is put into them is escaped and printable.

    Made once: a page takes less time to fill in than its template to compile.
    """
    return jinja2.Environment(
        loader=jinja2.PackageLoader("armodal.analyzer.report", "."),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        finalize=lambda value: printable(value) if type(value) is str else value,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def shown(text: object) -> str:
    """Return a label as a figure may carry it: the figures' library takes HTML in labels."""
    return str(escape(printable(str(text))))
