"""Xacro to URDF, by xacrodoc, where it is installed, in a process of its own."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Sequence
from contextlib import redirect_stderr, suppress
from importlib import import_module
from pathlib import Path

from armodal.protocols.apart import apart, bytes_allowed
from armodal.protocols.errors import ArmError, MissingPackageError

__all__ = ["expand_xacro", "expanded", "prepare"]

_LONGEST = 300
_ERRNO = re.compile(r"\[Errno -?\d+\] ?")
_ARGUMENT = re.compile(r"""<xacro:arg\b(?=[^>]*?\bname\s*=\s*["']([^"']+))([^>]*)>""")
_HIGHEST = 6  # folders above the file whose packages are taken


def expand_xacro(
    path: Path, *, folders: Sequence[Path] = (), arguments: dict[str, str] | None = None
) -> str:
    """Return the URDF text of a xacro file.

    Parameters
    ----------
    folders
        Folders in which packages of `$(find ...)` are looked for, first.
    arguments
        Values of the file's `xacro:arg`.

    Raises
    ------
    MissingPackageError
        If xacrodoc is not installed.
    ArmError
        If the file cannot be expanded.
    """
    found = [] if arguments is None else sorted(arguments.items())
    return apart(
        f"{__name__}:expanded",
        {"path": str(path), "folders": [str(folder) for folder in folders], "arguments": found},
        most_bytes=bytes_allowed(path.read_text("utf-8", "replace")),
        what=path.name,
    )


def prepare() -> None:
    """Load the package, which takes memory of its own."""
    with suppress(ImportError):
        import_module("xacrodoc")


def expanded(path: str, folders: list[str], arguments: list[list[str]]) -> str:
    """Expand in this process; as `expand_xacro`."""
    return _expanded(Path(path), folders, {own[0]: own[1] for own in arguments})


def _expanded(path: Path, folders: list[str], arguments: dict[str, str]) -> str:
    try:
        xacrodoc = import_module("xacrodoc")
        packages = import_module("xacrodoc.packages")
    except ImportError as problem:
        raise MissingPackageError(
            f"wanted the package xacrodoc for {path.name}, it is not installed; install it with "
            "`pip install 'armodal[robots]'`, or expand the file to a URDF"
        ) from problem
    packages.reset()
    if folders:
        packages.look_in(folders)
    beside: dict[str, str] = {}
    for folder in list(path.resolve().parents)[:_HIGHEST]:
        for one in _packages_in(folder):
            beside.setdefault(one.name, str(one))
    said = io.StringIO()
    try:
        with warnings.catch_warnings(), redirect_stderr(said):
            warnings.simplefilter("ignore")
            packages.walk_up_from(str(path.resolve().parent))
            packages.update_package_cache(beside)
            # Included by its path, so that its own includes are looked for beside it.
            document = xacrodoc.XacroDoc.from_includes(
                [str(path.resolve())],
                name=_robot_name(path),
                subargs=_of_root(path) | arguments,
                resolve_packages=False,
            )
            return str(document.to_urdf_string())
    except Exception as problem:
        text = " ".join(_ERRNO.sub("", str(problem)).split())[:_LONGEST] or type(problem).__name__
        raise ArmError(
            f"{path.name}: wanted a xacro file that can be expanded, got: {text}; packages it "
            "includes are looked for beside its folders, and in those given with --packages"
            f"{_unset(path, arguments)}"
        ) from problem
    finally:
        packages.reset()


def _of_root(path: Path) -> dict[str, str]:
    """Defaults of the arguments in the root's own attributes, which xacro reads before them."""
    text = path.read_text("utf-8", "replace")
    root = re.search(r"<robot\b[^>]*>", text)
    wanted = re.findall(r"\$\(arg ([^)\s]+)\s*\)", root.group() if root else "")
    return {
        name: default.group(1)
        for name, rest in _ARGUMENT.findall(text)
        if name in wanted and (default := re.search(r"""default\s*=\s*["']([^"'$]+)["']""", rest))
    }


def _unset(path: Path, arguments: dict[str, str]) -> str:
    """Tell which arguments of the file have no value."""
    text = path.read_text("utf-8", "replace")
    names = [
        name
        for name, rest in _ARGUMENT.findall(text)
        if name not in arguments and not re.search(r"""default\s*=\s*["'][^"']""", rest)
    ]
    return f"; without a value: {', '.join(names)}, give it with --arg NAME:=VALUE" if names else ""


def _robot_name(path: Path) -> str:
    found = re.search(
        r"<robot\b[^>]*?\bname\s*=\s*[\"']([^\"'$]+)", path.read_text("utf-8", "replace")
    )
    return found.group(1) if found else path.name.split(".")[0]


def _packages_in(folder: Path) -> list[Path]:
    try:
        return [one for one in folder.iterdir() if (one / "package.xml").is_file()]
    except OSError:
        return []
