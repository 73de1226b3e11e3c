"""Figures that move and zoom, drawn in the page when they are asked for.

The library that draws them lies in the page once, packed, or beside many reports as one file. It
is unpacked at the first figure opened, so a page opens at once and prints without it.
"""

from __future__ import annotations

import gzip
from base64 import b64encode
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any

import plotly
from plotly.offline import get_plotlyjs

from armodal.analyzer.report.page_text import shown
from armodal.protocols.text_file import replace_text

__all__ = ["OpenFigures", "PlotlyHome"]

_PACKAGE = Path(__file__).parent


class PlotlyHome(StrEnum):
    """Where the library that draws figures lies."""

    EMBEDDED = "embedded"  # in every page
    SHARED = "shared"  # in one file beside the pages


class OpenFigures:
    """The figures of one page; `closing` goes at its end."""

    def __init__(self, home: PlotlyHome = PlotlyHome.EMBEDDED) -> None:
        self._home = home
        self._specs: list[str] = []

    def button(self, figure: Any, label: str) -> str:
        """A button that opens a plotly figure."""
        return self._place(figure, f"<button>{shown(label)}</button>", "screen")

    def at_once(self, figure: Any) -> str:
        """A plotly figure that is drawn as the page opens."""
        return self._place(figure, "", "")

    def _place(self, figure: Any, inside: str, css: str) -> str:
        number = len(self._specs)
        # A text in it may hold "</script>": no "<" of JSON means anything else.
        spec: str = figure.to_json()
        self._specs.append(spec.replace("<", "\\u003c"))
        return f'<div class="{css}" data-figure="figure-{number}">{inside}</div>'

    def closing(self) -> str:
        """The figures' data, the library and the script that opens them; empty without figures."""
        if not self._specs:
            return ""
        data = "".join(
            f'<script type="application/json" id="figure-{number}">{spec}</script>'
            for number, spec in enumerate(self._specs)
        )
        home = (
            f'<script type="text/plain" id="plotly" data-beside="{_file_name()}"></script>'
            if self._home is PlotlyHome.SHARED
            else f'<script type="text/plain" id="plotly">{_packed()}</script>'
        )
        return f"{data}{home}<script>{_opener()}</script>"

    def later_scripts(self) -> tuple[str, ...]:
        """Scripts that the page itself puts in later, for its policy."""
        return (get_plotlyjs(),) if self._specs and self._home is PlotlyHome.EMBEDDED else ()

    def trusts_its_script(self) -> bool:
        """Whether the page's own script may bring a file from beside the page."""
        return bool(self._specs) and self._home is PlotlyHome.SHARED

    def write_beside(self, page: Path) -> None:
        """Write the shared library beside the page where it is not yet.

        Raises
        ------
        SessionError
            If the file cannot be written.
        """
        path = page.with_name(_file_name())
        if self.trusts_its_script() and not path.exists():
            replace_text(path, get_plotlyjs())


def _file_name() -> str:
    return f"plotly-{plotly.__version__}.min.js"


@cache
def _packed() -> str:
    return b64encode(gzip.compress(get_plotlyjs().encode(), compresslevel=6, mtime=0)).decode()


@cache
def _opener() -> str:
    return (_PACKAGE / "open_figures.js").read_text(encoding="utf-8")
