"""A session looked at while it is measured."""

from __future__ import annotations

import asyncio
import os
import shutil
from collections import Counter
from dataclasses import replace

import pytest
from support.screen import screen_text

from armodal.daq.journal_writer import JournalWriter
from armodal.protocols.session.journal import encode_hit
from armodal.tui.screens.review.follow_app import FollowApp
from armodal.tui.screens.review.following import FollowedJournal


@pytest.fixture(scope="module")
def hits(session):
    """Those of the first two postures at every other point, four a point, in order."""
    postures = session.header.plan.postures[:2]
    return [
        [
            hit
            for hit in session.hits
            if hit.posture == own.name and hit.sensor_point in own.points[::2]
        ]
        for own in postures
    ]


@pytest.fixture
def writer(session, tmp_path):
    made = JournalWriter.create(tmp_path / "s.journal", session.header)
    yield made
    made.close()


def put(writer, hits):
    for hit in hits:
        writer.append(encode_hit(hit))


def test_what_was_accepted_is_there_and_the_journal_is_left_alone(writer, hits):
    followed = FollowedJournal(writer.path)
    assert followed.newer(()) is None
    put(writer, hits[0])
    before = writer.path.stat()
    first = followed.newer(())
    assert [view.name for view in first.views] == [hits[0][0].posture]
    assert first.views[0].model is not None
    assert followed.newer(first.views) is None
    put(writer, hits[1][: len(hits[1]) // 2])
    second = followed.newer(first.views)
    assert len(second.views) == 2
    assert second.views[0] is first.views[0]  # no hit since: not fitted again
    record = encode_hit(hits[1][-1])
    with writer.path.open("ab") as file:  # as a record that is being written
        file.write(record[:1000])
    assert followed.newer(second.views) is None
    after = writer.path.stat()
    assert (after.st_mode, after.st_ino, after.st_nlink) == (
        before.st_mode, before.st_ino, before.st_nlink,
    )  # fmt: skip
    assert sorted(p.name for p in writer.path.parent.iterdir() if "h5" in p.name) == []


def test_rejected_hits_change_nothing(writer, hits, session):
    put(writer, hits[0])
    followed = FollowedJournal(writer.path)
    first = followed.newer(())
    last = hits[0][-1]
    rejected = replace(last.verdict, accepted=False, reasons=("double",))
    put(writer, [replace(last, number=last.number + 1, verdict=rejected)])
    assert followed.newer(first.views) is None


def test_picked_poles_stay_picked(writer, hits):
    half = len(hits[0]) // 2
    put(writer, hits[0][:half])
    followed = FollowedJournal(writer.path)
    (view,) = followed.newer(()).views
    picked = replace(view, picks=view.picks[:2], by_hand=True)
    put(writer, hits[0][half:])
    (view,) = followed.newer((picked,)).views
    assert view.by_hand
    assert len(view.model.modes) == 2


def looked(followed):
    """What a look finds, and what it has to say of the journal."""
    return followed.newer(()), followed.remark()


def test_a_journal_that_is_none_is_told_once(tmp_path):
    path = tmp_path / "s.journal"
    path.write_bytes(b"something else")
    followed = FollowedJournal(path)
    found, said = looked(followed)
    assert found is None
    assert "not an armodal journal" in said
    assert looked(followed) == (None, "")


@pytest.mark.long
def test_a_journal_that_goes_and_comes_back_is_told_once(writer, hits):
    put(writer, hits[0])
    followed = FollowedJournal(writer.path)
    assert looked(followed)[1] == ""
    aside = writer.path.rename(writer.path.with_suffix(".aside"))
    assert looked(followed) == (
        None,
        "s.journal cannot be read (it is not there); shown is what it held",
    )
    assert looked(followed) == (None, "")
    aside.rename(writer.path)
    assert looked(followed) == (None, "")


def test_a_journal_that_is_cut_is_told_in_one_line(writer, hits):
    put(writer, hits[0])
    size = writer.path.stat().st_size
    put(writer, hits[1])
    followed = FollowedJournal(writer.path)
    assert len(looked(followed)[0].views) == 2
    os.truncate(writer.path, size)
    found, said = looked(followed)
    assert len(found.views) == 1
    assert said == f"s.journal was cut: {len(hits[1])} accepted hits are not in it any more"
    assert looked(followed) == (None, "")


@pytest.mark.long
def test_a_journal_that_is_replaced_is_told_in_one_line(writer, hits):
    put(writer, hits[0])
    followed = FollowedJournal(writer.path)
    looked(followed)
    other = writer.path.with_suffix(".other")
    shutil.copy(writer.path, other)
    other.replace(writer.path)
    found, said = looked(followed)
    assert found is None
    assert said == "s.journal was replaced by another file: shown is what that holds"
    assert looked(followed) == (None, "")


def test_the_screen_shows_hits_as_they_come(writer, hits):
    async def shown(app, pilot, words):
        while words not in screen_text(app):
            await pilot.pause(0.01)

    async def main():
        app = FollowApp(writer.path, look_s=0.02)
        async with app.run_test(size=(100, 30)) as pilot:
            await shown(app, pilot, "waiting for accepted hits")
            put(writer, hits[0])
            await shown(app, pilot, "posture 1/1")
            put(writer, hits[1])
            await shown(app, pilot, "posture 1/2")
            counts = Counter(hit.posture for hit in app.state.opened.session.hits)
            assert counts == {group[0].posture: len(group) for group in hits}
            await pilot.press("q")
        return app.return_code

    assert asyncio.run(asyncio.wait_for(main(), 120.0)) == 0
