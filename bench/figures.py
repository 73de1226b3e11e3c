"""Figures of a torture, printed as rows of a table that `torture.py` puts together."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """What was counted, how much was reached and wanted, and whether that is enough."""

    what: str
    reached: str
    wanted: str
    good: bool


def told(figures: list[Figure]) -> int:
    """Print the rows; return the exit code."""
    for figure in figures:
        word = "yes" if figure.good else "NO"
        print(f"| {figure.what} | {figure.reached} | {figure.wanted} | {word} |", flush=True)
    return 0 if all(figure.good for figure in figures) else 1
