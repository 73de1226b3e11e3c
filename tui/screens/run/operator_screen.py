"""What a screen of the operator offers: `steps` is searched for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pkgutil import iter_modules

from armodal.tui.screens.run import steps
from armodal.tui.screens.run.state import RunState
from armodal.tui.screens.run.step_screen import StepScreen

__all__ = ["OperatorScreen", "needed_screen", "operator_screens"]


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatorScreen:
    """A screen of the session; its module's name is its own.

    Attributes
    ----------
    make
        Makes it, once for the app.
    needed
        Whether the operator needs it now. Screens are asked in the order of their places.
    place
        In that order, the lowest first; of the same place, by name.
    key
        The key that shows it during the session and takes it away again; none by default.
    words
        Beside the key.
    """

    make: Callable[[], StepScreen]
    needed: Callable[[RunState], bool] = lambda _: False
    place: int = 0
    key: str = ""
    words: str = ""


@lru_cache(maxsize=1)
def operator_screens() -> dict[str, OperatorScreen]:
    """Return every screen by the name of its module, in the order in which they are asked."""
    names = [module.name for module in iter_modules(steps.__path__)]
    found = {name: import_module(f"{steps.__name__}.{name}").SCREEN for name in names}
    return dict(sorted(found.items(), key=lambda item: (item[1].place, item[0])))


def needed_screen(state: RunState, screens: Mapping[str, OperatorScreen]) -> str:
    """Return the name of the screen the operator needs now.

    Raises
    ------
    StopIteration
        If no screen is needed; of those found the last one always is.
    """
    return next(name for name, screen in screens.items() if screen.needed(state))
