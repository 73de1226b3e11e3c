from dataclasses import asdict

from rich.style import Style

from armodal.tui.screens.themes import inks_of


def test_what_is_looked_at_differs_from_what_lies_beneath_without_colour():
    inks = inks_of({"foreground": "#ffffff", "background": "#000000"})
    assert Style.parse(inks.strong).bold
    assert not Style.parse(inks.weak).bold
    assert Style.parse(inks.bad).reverse


def test_every_ink_is_a_style_whatever_the_theme_says():
    for variables in ({}, {"primary": "ansi_blue", "foreground": "auto 87%"}):
        for style in asdict(inks_of(variables)).values():
            Style.parse(style)
