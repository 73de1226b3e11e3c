"""Where commands speak: data to stdout, the rest to stderr."""

from __future__ import annotations

import json
import sys
from typing import Annotated

import typer
from rich.console import Console

from daq.clock import check_time_scale

__all__ = ["Json", "TimeScale", "err", "out", "print_json", "say"]

out = Console(highlight=False)
err = Console(stderr=True, highlight=False)

Json = Annotated[bool, typer.Option("--json", help="Print one JSON object on stdout.")]


def _checked(scale: float) -> float:
    check_time_scale(scale)
    return scale


TimeScale = Annotated[float, typer.Option(callback=_checked, help="Lab seconds a second.")]


def say(text: str) -> None:
    """Tell what is being done."""
    err.print(f"· {text}", markup=False, style="dim")


def print_json(value: object) -> None:
    """Print one JSON object."""
    sys.stdout.write(json.dumps(value, indent=2) + "\n")
