"""Options that a command would leave unused, refused where the user gave them."""

from __future__ import annotations

from collections.abc import Collection

import typer

from armodal.protocols.errors import SessionError

__all__ = ["refuse_idle"]


def refuse_idle(context: typer.Context, idle: Collection[str], *, here: str, there: str) -> None:
    """Refuse what was given although it has no effect here; defaults pass.

    Parameters
    ----------
    idle
        Names of the command's parameters.
    here, there
        What the command was called with, and what these options belong to.

    Raises
    ------
    SessionError
        If one was given; all are named as the user wrote them.
    """
    given = []
    for parameter in context.command.params:
        source = context.get_parameter_source(parameter.name or "")
        if parameter.name in idle and source is not None and source.name != "DEFAULT":
            given.append(parameter.opts[0])
    if given:
        raise SessionError(
            f"wanted {', '.join(given)} with {there} only, got {here}; leave "
            f"{'it' if len(given) == 1 else 'them'} out, or give {there} in place of {here}"
        )
