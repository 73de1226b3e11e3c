"""What a fit says beside its table is on the screen of modes."""

from dataclasses import replace

from support.screen import laid_out

from armodal.analyzer.modal import drift_told
from armodal.tui.screens.review.model_notes import ModelNotes, model_notes


def with_model(app, model):
    app.state.views[app.state.posture] = replace(app.state.view, model=model)


def test_modes_that_move_and_peaks_without_modes_stand_under_the_table(drive, moving):
    _, moved = moving

    async def steps(app, pilot):
        app.action_tab("modes")
        model = app.state.view.model
        with_model(app, replace(model, notes=()))
        app.redraw()
        notes = app.query_one(ModelNotes)
        await laid_out(pilot, lambda: not notes.display)  # all columns have room
        known = len(app.state.view.joint_share)
        drifting = replace(moved, modes=moved.modes[:known], notes=("a peak at 12 Hz",))
        with_model(app, drifting)
        app.redraw()
        await laid_out(pilot, lambda: notes.display and notes.region.height > 0)
        said = model_notes(app.state)
        assert said[-1] == "a peak at 12 Hz"
        assert said[0] == f"moves: {drift_told(drifting)[0].words}"

    drive(steps)
