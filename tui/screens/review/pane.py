"""What a screen of review offers: `panes` is searched for them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pkgutil import iter_modules
from time import monotonic

from textual.widget import Widget

from armodal.tui.screens.review import panes
from armodal.tui.screens.review.command_run import ARMODAL
from armodal.tui.screens.review.state import ReviewState

__all__ = ["PaneParts", "ReviewPane", "review_panes"]

BEHIND = 100  # the place of a pane that names none: behind those that do


@dataclass(frozen=True, slots=True, kw_only=True)
class PaneParts:
    """What a pane may be made of.

    Attributes
    ----------
    state
        The session, the posture and mode looked at, results.
    clock
        Seconds, for what moves.
    command
        How armodal is started for what takes long.
    """

    state: ReviewState
    clock: Callable[[], float] = monotonic
    command: tuple[str, ...] = ARMODAL


@dataclass(frozen=True, slots=True, kw_only=True)
class ReviewPane:
    """A screen of review; its module's name is its own.

    Attributes
    ----------
    title
        On its tab.
    make
        Returns the widgets; the first takes the keys. What has a method `redraw` is told when the
        session, posture or mode has changed.
    place
        Among the tabs, the lowest first; of the same place, by name.
    """

    title: str
    make: Callable[[PaneParts], tuple[Widget, ...]]
    place: int = BEHIND


@lru_cache(maxsize=1)
def review_panes() -> dict[str, ReviewPane]:
    """Return every pane by the name of its module, in the order of the tabs."""
    names = [module.name for module in iter_modules(panes.__path__)]
    found = {name: import_module(f"{panes.__name__}.{name}").PANE for name in names}
    return dict(sorted(found.items(), key=lambda item: (item[1].place, item[0])))
