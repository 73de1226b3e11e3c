"""A session looked at while it is measured: its journal is read again whenever it has grown.

Nothing is written and nothing locked: whoever measures does not notice. A record that is being
written is not whole yet, and is read the next time.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

from armodal.protocols.errors import EstimateError, SessionError
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
        self._size = -1
        self._hits = Counter[str]()

    def newer(self, shown: tuple[PostureView, ...]) -> OpenSession | None:
        """Return the session with its modes fitted, or None where no accepted hit came or went.

        Parameters
        ----------
        shown
            What is shown of it; a posture that got no hits since stays as it is, and poles picked
            by hand stay picked.

        Raises
        ------
        JournalError
            If the journal cannot be read.
        """
        size = self.path.stat().st_size if self.path.exists() else 0
        if size == self._size:
            return None
        session = load_journal(self.path)
        self._size = size
        hits = _accepted(session)
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
