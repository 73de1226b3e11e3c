"""What a line of the home screen offers: `choices` is searched for them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from textual.app import App

from armodal.tui.screens.home import choices
from armodal.tui.screens.wishes import Wish

__all__ = ["HomeChoice", "HomeParts", "home_choices"]

BEHIND = 100  # the place of a choice that names none: behind those that do


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeParts:
    """What a choice may use.

    Attributes
    ----------
    app
        Shows a screen, or is left with a wish.
    folder
        Where sessions are, and new ones go.
    ports
        Serial ports of this machine: (path, description) of each.
    arm_made
        Arm file just made, which a new session is begun with.
    """

    app: App[Wish]
    folder: Path
    ports: Callable[[], Sequence[tuple[str, str]]]
    arm_made: Path | None = None

    def leave_with(self, wish: Wish | None) -> None:
        """Leave the app, unless nothing was wished."""
        if wish is not None:
            self.app.exit(wish)


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeChoice:
    """A line of the home screen, and its key.

    Attributes
    ----------
    key, label
        The key, and what stands beside it in the line of keys.
    words
        The line in the list.
    chosen
        What happens.
    place
        Among the lines, the lowest first; of the same place, by name.
    measures
        Whether it is offered only where devices run.
    in_key_line
        Whether the line of keys has it too.
    """

    key: str
    label: str
    words: str
    chosen: Callable[[HomeParts], None]
    place: int = BEHIND
    measures: bool = False
    in_key_line: bool = True


@lru_cache(maxsize=1)
def home_choices() -> dict[str, HomeChoice]:
    """Return every choice by the name of its module, in the order of the list."""
    names = [module.name for module in iter_modules(choices.__path__)]
    found = {name: import_module(f"{choices.__name__}.{name}").CHOICE for name in names}
    return dict(sorted(found.items(), key=lambda item: (item[1].place, item[0])))
