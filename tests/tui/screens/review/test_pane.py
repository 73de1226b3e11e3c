"""The screens found in the folder: each with a tab of its own, and room at the smallest size."""

from armodal.tui.screens.review.pane import review_panes

SMALLEST = (80, 24)


def test_panes_stand_by_their_places_under_titles_of_their_own():
    panes = list(review_panes().values())
    assert [pane.place for pane in panes] == sorted(pane.place for pane in panes)
    assert len({pane.title for pane in panes}) == len(panes)


def test_every_pane_found_takes_the_keys_and_keeps_within_the_smallest_window(drive):
    async def steps(app, pilot):
        for name in review_panes():
            app.action_tab(name)
            await pilot.pause()
            main = app.query_one(f"#{name}-main")
            assert main.has_focus
            assert main.region.right <= SMALLEST[0]
            assert main.region.bottom <= SMALLEST[1]

    drive(steps, size=SMALLEST, panes=review_panes())
