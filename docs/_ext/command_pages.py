"""A page for every command, from its own help."""

from __future__ import annotations

import re
from typing import Any

import typer

from armodal.tui.cli import app

# An option in the words of a help, and not in its code: what is there already stays as it is.
_OPTION = re.compile(r"`[^`]*`|(?<![\w-])--?[a-z][a-z-]*")
_EXAMPLE = re.compile(r"^Example: (.+)$", re.MULTILINE)


def command_pages() -> dict[str, str]:
    """Return the index of commands and a page for each, by file name."""
    group: Any = typer.main.get_command(app)
    pages, rows = {}, []
    for name in group.commands:
        command = group.commands[name]
        pages[f"commands/{name}.md"] = _page(f"armodal {name}", command)
        rows.append(f"| [`armodal {name}`]({name}.md) | {_first_line(command)} |")
    names = "\n".join(group.commands)
    table = "\n".join(["| command | does |", "|---|---|", *rows])
    pages["commands/index.md"] = (
        f"# Commands\n\nResults go to stdout, everything else to stderr. A user's mistake is one "
        f"message and exit code 2. `armodal --install-completion` completes commands and options "
        f"in the shell.\n\n{table}\n\n```{{toctree}}\n:hidden:\n\n{names}\n```\n"
    )
    return pages


def _first_line(command: Any) -> str:
    return _words((command.help or "").strip().split("\n")[0])


def _words(text: str) -> str:
    """A help's words, options as code: two hyphens would become a dash."""
    return _OPTION.sub(lambda found: f"`{found[0].strip('`')}`", text)


def _help(text: str) -> list[str]:
    """A help without its examples, and these as commands to copy."""
    said = _words(_EXAMPLE.sub("", text).strip())
    examples = _EXAMPLE.findall(text)
    return [said, "", "```text", *examples, "```", ""] if examples else [said, ""]


def _page(title: str, command: Any, level: int = 1) -> str:
    text = [f"{'#' * level} {title}", "", *_help((command.help or "").strip())]
    rows = [_row(parameter) for parameter in command.params if not getattr(parameter, "hidden", 0)]
    if rows:
        text += ["| option | meaning |", "|---|---|", *rows, ""]
    for name, inner in getattr(command, "commands", {}).items():
        text.append(_page(f"{title} {name}", inner, level + 1))
    return "\n".join(text)


def _row(parameter: Any) -> str:
    is_argument = parameter.param_type_name == "argument"
    name = (parameter.metavar or parameter.name).upper()
    if not is_argument:
        name = ", ".join(parameter.opts)
    if parameter.secondary_opts:
        name += " / " + ", ".join(parameter.secondary_opts)
    meaning = _words(getattr(parameter, "help", None) or "").replace("\n", " ")
    default = parameter.default
    if isinstance(default, bool) and parameter.secondary_opts:
        default = (parameter.opts if default else parameter.secondary_opts)[0]
        default = f"`{default}`"
    if parameter.required:
        meaning += " Required."
    elif default not in (None, False, (), "", ...) and not callable(default):
        meaning += f" Default: {default}."
    cells = (cell.replace("|", "\\|") for cell in (f"`{name}`", meaning.strip()))
    return f"| {' | '.join(cells)} |"
