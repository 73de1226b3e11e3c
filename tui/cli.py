"""The `armodal` command: each of its commands is loaded when it is called."""

from __future__ import annotations

import pkgutil
import sys
from collections.abc import Iterator, MutableMapping
from contextlib import contextmanager
from functools import lru_cache
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from armodal import SOFTWARE
from armodal.protocols.errors import ArmodalError, SessionError
from armodal.protocols.os_words import os_words
from armodal.protocols.printable import printable
from armodal.tui import commands
from armodal.tui.console import err, out
from armodal.tui.this_system import check_runs_devices, runs_devices

__all__ = ["app", "main"]

USER_ERROR = 2
# Commands in the order of the help; any other stands behind them, by its name.
FIRST = (
    "demo", "sim", "devices", "acquire", "run", "recover", "inspect", "import", "export", "merge",
    "review", "arm", "plan", "mozzi", "workspace", "calibrate-inertia", "reproduce", "fit",
    "identify", "predict", "shaper", "stiffness-map", "chatter", "model", "report", "gap",
    "gap-study", "check", "can",
)  # fmt: skip
_USAGE_ERROR: Any = typer.BadParameter.__base__  # which typer has from click, or from a copy of it
OF_DEVICES = frozenset({"demo", "sim", "devices", "acquire", "run"})


@lru_cache(maxsize=1)
def command_modules() -> dict[str, str]:
    """Return every command's module: of a name that Python takes, it ends in an underscore.

    The module's `app` holds the command, or is a group of that name.
    """
    found = (module.name for module in pkgutil.iter_modules(commands.__path__))
    modules = {name.rstrip("_").replace("_", "-"): name for name in found}
    order = (*(name for name in FIRST if name in modules), *sorted(modules.keys() - set(FIRST)))
    return {name: modules[name] for name in order}


class _Loaded(MutableMapping[str, Any]):
    """Commands by name, each imported when it is first asked for."""

    def __init__(self) -> None:
        self._found: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._found:
            if name in OF_DEVICES and not runs_devices():
                app = _refusing(name)
            else:
                app = import_module(f"{commands.__name__}.{command_modules()[name]}").app
            group: Any = typer.main.get_command(app)
            command = getattr(group, "commands", {}).get(name, group)
            command.name = name
            self._found[name] = command
        return self._found[name]

    def __setitem__(self, name: str, command: Any) -> None:
        self._found[name] = command

    def __delitem__(self, name: str) -> None:
        del self._found[name]

    def __iter__(self) -> Iterator[str]:
        return iter(command_modules())

    def __len__(self) -> int:
        return len(command_modules())


def _refusing(name: str) -> typer.Typer:
    """Return a command that says on which systems it is to be had."""
    app = typer.Typer()

    @app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
    def refuse() -> None:
        """Not on this system: needs Linux or macOS."""
        check_runs_devices(name)

    return app


class _Armodal(TyperGroup):
    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.commands = _Loaded()

    def make_context(self, *given: Any, **settings: Any) -> Any:
        with _printable_usage():
            return super().make_context(*given, **settings)

    def invoke(self, ctx: Any) -> Any:
        with _printable_usage():
            return super().invoke(ctx)


@contextmanager
def _printable_usage() -> Iterator[None]:
    """Write out, in errors of usage, what names of files among the arguments would steer."""
    try:
        yield
    except _USAGE_ERROR as error:
        error.message = printable(error.message)
        raise


app = typer.Typer(
    cls=_Armodal, no_args_is_help=False, add_completion=True, pretty_exceptions_enable=False
)


def _version(wanted: bool) -> None:
    if wanted:
        out.print(SOFTWARE)
        raise typer.Exit


@app.callback(invoke_without_command=True)
def _armodal(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    """Test a robot arm with a hammer: from the hit to a model that explains the measurement.

    Without a command, in a terminal, the home screen opens: everything is reached from there.
    """
    del version  # it has ended the command where it was given
    if context.invoked_subcommand is not None:
        return
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        out.print(context.get_help())
        raise typer.Exit(USER_ERROR)
    journey = import_module("armodal.tui.command_parts.journey")
    raise typer.Exit(journey.go_from(import_module("armodal.tui.screens.wishes").GoHome()))


def _refuse_line_ends() -> None:
    """What is told of a name with a line end would seem to be said by armodal.

    Raises
    ------
    SessionError
        If an argument has one.
    """
    for given in sys.argv[1:]:
        if "\n" in given:
            raise SessionError(
                f"wanted arguments of one line each, got '{printable(given, keep='')}'; rename the "
                "file"
            )


def main() -> None:
    """Run the command line: a user's mistake is one message and exit code 2."""
    try:
        _refuse_line_ends()
        app(prog_name="armodal", standalone_mode=True)
    except ArmodalError as error:
        err.print(f"armodal: {error}")
        sys.exit(USER_ERROR)
    except OSError as error:
        problem = SessionError(f"{error.filename or 'file'}: {os_words(error)}")
        err.print(f"armodal: {problem}")
        sys.exit(USER_ERROR)
    except KeyboardInterrupt:
        err.print("armodal: stopped")
        sys.exit(130)


if __name__ == "__main__":
    main()
