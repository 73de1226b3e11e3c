"""The lines of the home screen: in the order of their places, each with a key of its own."""

from textual.binding import Binding

from armodal.tui.screens.home.app import HomeApp
from armodal.tui.screens.home.choice import home_choices


def test_choices_stand_by_their_places():
    places = [choice.place for choice in home_choices().values()]
    assert places == sorted(places)


def test_no_two_keys_of_the_home_screen_are_the_same():
    keys = [one.key for one in HomeApp.BINDINGS if isinstance(one, Binding)]
    assert {one.key for one in home_choices().values()} <= set(keys)
    assert sorted(set(keys)) == sorted(keys)
