"""A session looked at while it is measured: its journal is read again whenever it has grown.

Nothing is written and nothing locked: whoever measures does not notice. A record that is being
written is not whole yet, and is read the next time. A journal that goes, is replaced or is cut is
told once.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

from armodal.protocols.errors import EstimateError, JournalError, SessionError
from armodal.protocols.os_words import os_words
from armodal.protocols.session.journal import load_journal
from armodal.protocols.session.records import Session
from armodal.tui.screens.review.posture_view import (
    OpenSession,
    PostureView,
    fit_automatic,
    fit_picked,
    opened_session,
)

__all__ = ["FollowedJournal"]


class FollowedJournal:
    """A journal that is being written.

    Parameters
    ----------
    journal
        The file; that of the session, with its suffix .h5, need not be there yet.
    """

    def __init__(self, journal: Path) -> None:
        self.path = journal
        self._file: tuple[int, int] | None = None  # what it is on its disk, and its size
        self._hits = Counter[str]()
        self._fault = ""
        self._untold = ""

    def remark(self) -> str:
        """Return what has happened to the journal since the last look, once; else nothing."""
        told, self._untold = self._untold, ""
        return told

    def newer(self, shown: tuple[PostureView, ...]) -> OpenSession | None:
        """Return the session with its modes fitted, or None where no accepted hit came or went.

        What is wrong with the journal is for `remark`.

        Parameters
        ----------
        shown
            What is shown of it; a posture that got no hits since stays as it is, and poles picked
            by hand stay picked.
        """
        try:
            status = self.path.stat()
            file = (status.st_ino, status.st_size)
            if file == self._file:
                return None
            session = load_journal(self.path)
        except (OSError, JournalError) as error:
            self._tell_fault(error)
            return None
        hits, earlier = _accepted(session), self._file
        self._fault, self._file = "", file
        if earlier is not None and earlier[0] != file[0]:
            self._untold = (
                f"{self.path.name} was replaced by another file: shown is what that holds"
            )
        elif self._hits - hits:
            lost = (self._hits - hits).total()
            self._untold = f"{self.path.name} was cut: {lost} accepted hits are not in it any more"
        if hits == self._hits:
            return None
        try:
            opened = opened_session(self.path.with_suffix(".h5"), session)
        except SessionError:  # no posture has enough hits yet
            return None
        kept = {view.name: view for view in shown if hits[view.name] == self._hits[view.name]}
        before = {view.name: view for view in shown}
        self._hits = hits
        return replace(
            opened,
            views=tuple(
                kept.get(view.name) or _fitted(opened, view, before.get(view.name))
                for view in opened.views
            ),
        )

    def _tell_fault(self, error: Exception) -> None:
        """Once, until the journal is read again."""
        fault = str(error)
        if isinstance(error, OSError):
            fault = f"{self.path.name} cannot be read ({os_words(error)}); shown is what it held"
        if fault != self._fault:
            self._fault = self._untold = fault


def _accepted(session: Session) -> Counter[str]:
    return Counter(hit.posture for hit in session.hits if hit.verdict.accepted)


def _fitted(opened: OpenSession, view: PostureView, before: PostureView | None) -> PostureView:
    fitted = fit_automatic(opened.superset, view)
    if before is None or not (before.by_hand or before.changed) or fitted.automatic is None:
        return fitted
    try:
        return fit_picked(opened.superset, replace(fitted, picks=before.picks))
    except EstimateError:
        return fitted
