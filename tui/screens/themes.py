"""Themes of the terminal app, and the inks its pictures are drawn with."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from textual.app import App
from textual.theme import Theme

__all__ = ["MONO", "Inks", "inks_of", "register_themes", "use_next_theme"]

MONO, INK, PAPER = "armodal-mono", "armodal-dark", "armodal-light"

_WEAK_SHARE = 0.42  # of the way from ground to ink

_THEMES = (
    Theme(
        name=INK,
        primary="#4fb3ff",
        secondary="#9fd0a0",
        accent="#ffb454",
        warning="#ffd166",
        error="#ff6b6b",
        success="#7bd88f",
        foreground="#e8eaed",
        background="#101418",
        surface="#161b21",
        panel="#1e252d",
        dark=True,
    ),
    Theme(
        name=PAPER,
        primary="#00539c",
        secondary="#2d6a4f",
        accent="#a14a00",
        warning="#8a5a00",
        error="#b00020",
        success="#1b6e3a",
        foreground="#15181c",
        background="#ffffff",
        surface="#f4f5f7",
        panel="#e7eaee",
        dark=False,
    ),
    Theme(
        name=MONO,
        primary="#ffffff",
        secondary="#d0d0d0",
        accent="#ffffff",
        warning="#ffffff",
        error="#ffffff",
        success="#ffffff",
        foreground="#ffffff",
        background="#000000",
        surface="#000000",
        panel="#303030",
        dark=True,
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Inks:
    """Rich styles of what pictures show; each differs from its neighbours without colour too."""

    plain: str
    weak: str  # what lies beneath
    strong: str  # what is looked at
    fit: str  # what a model says
    axis: str  # axes, marks of what was chosen
    cursor: str
    bad: str


def inks_of(variables: Mapping[str, str]) -> Inks:
    """Inks from a theme's variables (`App.theme_variables`)."""

    def colour(name: str, fallback: str) -> str:
        value = variables.get(name, fallback)
        return value if value.startswith("#") and len(value) == 7 else fallback

    plain, ground = colour("foreground", "#c0c0c0"), colour("background", "#000000")
    return Inks(
        plain=plain,
        weak=_between(ground, plain, _WEAK_SHARE),
        strong=f"bold {colour('primary', '#ffffff')}",
        fit=colour("accent", "#ffffff"),
        axis=f"bold {colour('error', '#ffffff')}",
        cursor=f"bold {colour('warning', '#ffffff')}",
        bad=f"bold reverse {colour('error', '#ffffff')}",
    )


def _between(ground: str, ink: str, share: float) -> str:
    """Colour `share` of the way from one to the other; both #rrggbb."""
    pairs = [(int(ground[i : i + 2], 16), int(ink[i : i + 2], 16)) for i in (1, 3, 5)]
    return "#" + "".join(f"{round(a + share * (b - a)):02x}" for a, b in pairs)


def register_themes(app: App[Any], environment: Mapping[str, str] = os.environ) -> None:
    """Give an app the themes, and choose: without colour where NO_COLOR is set, else dark."""
    for theme in _THEMES:
        app.register_theme(theme)
    app.theme = MONO if environment.get("NO_COLOR") else INK


def use_next_theme(app: App[Any]) -> None:
    """Go to the next of armodal's themes."""
    names = [name for name in app.available_themes if name.startswith("armodal")]
    at = names.index(app.theme) if app.theme in names else -1
    app.theme = names[(at + 1) % len(names)]
