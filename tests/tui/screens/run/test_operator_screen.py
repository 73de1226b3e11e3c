"""The screens found in the folder: one is always needed, and keys are told apart."""

from support.made_run import HIT_EVENTS, SESSION_EVENTS, after, fresh
from support.stage import Stage, play
from textual.binding import Binding

from armodal.tui.screens.run.app import RunApp
from armodal.tui.screens.run.operator_screen import needed_screen, operator_screens
from armodal.tui.screens.run.step_screen import Pane

SMALLEST = (80, 24)


def test_every_state_of_a_session_has_its_screen():
    events = (*SESSION_EVENTS, *HIT_EVENTS[len(SESSION_EVENTS) :])
    for n in range(len(events) + 1):
        assert needed_screen(after(fresh(), *events[:n]), operator_screens()) in operator_screens()


def test_no_two_keys_of_the_app_are_the_same():
    bindings = [one for one in RunApp.BINDINGS if isinstance(one, Binding)]
    keys = [key for one in bindings for key in one.key.split(",")]
    assert sorted(set(keys)) == sorted(keys)


def test_every_screen_found_keeps_within_the_smallest_window(tmp_path):
    stage = Stage(tmp_path, screens=operator_screens())

    async def body(pilot):
        await stage.tell(pilot, *HIT_EVENTS)
        for name in operator_screens():
            stage.app.action_call(name)
            await stage.settle(pilot)
            for pane in stage.app.screen.query("#body").first().children:
                assert pane.region.right <= SMALLEST[0]
                assert pane.region.bottom <= SMALLEST[1]
            assert stage.app.screen.query(Pane)
            stage.app.action_call(name)

    play(stage, body, SMALLEST)
