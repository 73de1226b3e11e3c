"""Modules of a folder by their names: what lies there needs no list anywhere else."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

__all__ = ["modules_of"]


def modules_of(package: str, path: Iterable[str]) -> dict[str, Any]:
    """Return the modules of a package by name, in the names' order."""
    names = sorted(found.name for found in iter_modules(list(path)))
    return {name: import_module(f"{package}.{name}") for name in names}
