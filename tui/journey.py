"""From screen to screen without leaving: each app ends with where to go on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from armodal.protocols.errors import ArmodalError
from armodal.tui.screens.wishes import GoHome, Wish

__all__ = ["Step", "travel"]

# What a step did: its exit code, and where it goes on; None ends.
Step = Callable[[Any], tuple[int, Wish | None]]


def travel(first: Wish, steps: Mapping[type, Step]) -> int:
    """Go on from wish to wish; a journey from the home screen comes back to it.

    Parameters
    ----------
    first
        Where it begins.
    steps
        What shows each kind of wish.

    Returns
    -------
    int
        Exit code of the last step.

    Raises
    ------
    ArmodalError
        If a wish cannot be shown and there is no home to say it.
    """
    wish: Wish | None = first
    code = 0
    while wish is not None:
        shown = wish
        try:
            code, wish = steps[type(shown)](shown)
        except ArmodalError as error:
            if not isinstance(first, GoHome):
                raise
            wish = GoHome(said=str(error))
        if wish is None and isinstance(first, GoHome) and not isinstance(shown, GoHome):
            wish = GoHome()
    return code
