"""A published figure and ours."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

__all__ = ["Figure", "FittedModel", "Status", "compared", "not_derivable", "statement"]


class Status(StrEnum):
    """How our figure came about, and whether it agrees."""

    PREDICTED = "predicted"  # from a model that never saw it
    CALIBRATED_TO = "calibrated-to"  # it was a target of the model
    SISTER = "sister paper"  # from a model made of another paper's figures of the same arm
    GEOMETRY = "by geometry"  # a statement that holds whatever the inertias and stiffnesses are
    RECOMPUTED = "recomputed"  # from other figures of the same print, by its own equation
    ERRATUM = "erratum"  # the print is wrong; ours is shown with the reason
    NOT_DERIVABLE = "not derivable"  # the print does not hold what it would take
    DIFFERS = "differs"  # further off than the margin


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedModel:
    """What a model was fitted to: how many parameters to how many figures."""

    arm: str
    parameters: int
    figures: int
    words: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One figure. Statements have True as published."""

    paper: str
    table: str
    item: str
    unit: str
    published: float | bool | str
    ours: float | bool | None
    margin: float | None  # of |ours - published|
    status: Status
    why: str  # of the margin, of the difference, or the number behind a statement
    ours_std: float | None = None  # one standard deviation of a prediction, where it has one


def compared(
    paper: str,
    table: str,
    item: str,
    unit: str,
    *,
    published: float,
    ours: float,
    margin: float,
    status: Status,
    why: str,
    ours_std: float | None = None,
) -> Figure:
    """Return a figure whose status is `differs` where it is further off than its margin."""
    agrees = abs(ours - published) <= margin
    return Figure(
        paper=paper,
        table=table,
        item=item,
        unit=unit,
        published=published,
        ours=float(ours),
        margin=margin,
        status=status if agrees else Status.DIFFERS,
        why=why,
        ours_std=ours_std,
    )


def statement(
    paper: str, table: str, item: str, *, holds: bool, status: Status, number: str, if_not: str = ""
) -> Figure:
    """Return a statement of the text as a computed yes or no with its number.

    `if_not` is the reason, given only with a no.
    """
    return Figure(
        paper=paper,
        table=table,
        item=item,
        unit="yes/no",
        published=True,
        ours=bool(holds),
        margin=None,
        status=status if holds else Status.DIFFERS,
        why=number if holds or not if_not else f"{number}; {if_not}",
    )


def not_derivable(paper: str, table: str, item: str, published: float | str, why: str) -> Figure:
    """Return a figure that cannot be had from what is printed."""
    return Figure(
        paper=paper,
        table=table,
        item=item,
        unit="",
        published=published,
        ours=None,
        margin=None,
        status=Status.NOT_DERIVABLE,
        why=why,
    )
