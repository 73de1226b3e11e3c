"""Review of a session that is being measured: what was accepted is shown within seconds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from textual import work

from armodal.protocols.errors import ArmodalError
from armodal.tui.screens.review.app import ReviewApp
from armodal.tui.screens.review.following import FollowedJournal
from armodal.tui.screens.review.posture_view import OpenSession, PostureView

__all__ = ["FollowApp"]

LOOK_S = 2.0  # between two looks at the journal


class FollowApp(ReviewApp):
    """Looks at a session while its journal is written.

    Parameters
    ----------
    journal
        Only read.
    gap
        Result of `armodal gap --json` to show.
    look_s
        Seconds between two looks at the journal.
    """

    def __init__(self, journal: Path, *, gap: Path | None = None, look_s: float = LOOK_S) -> None:
        super().__init__(journal.with_suffix(".h5"), gap=gap)
        self._followed = FollowedJournal(journal)
        self._look_s = look_s
        self._looking = False

    def begin(self) -> None:
        """Look at the journal now, and again and again."""
        self.say_status(f"{self._followed.path.name}: waiting for accepted hits … (q leaves)")
        self._look()
        self.set_interval(self._look_s, self._look)

    def _look(self) -> None:
        """See whether the journal has more, unless that is being done."""
        if not self._looking:
            self._looking = True
            self._read_newer(() if self.state is None else tuple(self.state.views))

    @work(thread=True)
    def _read_newer(self, shown: tuple[PostureView, ...]) -> None:
        opened = None
        try:
            opened = self._followed.newer(shown)
        except ArmodalError as error:
            self.call_from_thread(self.notify, str(error), severity="error", markup=False)
        told = self._followed.remark()
        if told:
            self.call_from_thread(self.notify, told, severity="warning", markup=False)
        show: Any = self._show_newer  # a coroutine: its end is waited for
        self.call_from_thread(show, opened)

    async def _show_newer(self, opened: OpenSession | None) -> None:
        self._looking = False
        if opened is None:
            return
        if self.state is None:
            await self.show_session(opened)
        else:
            self.state.renew(opened)
            self.redraw()
