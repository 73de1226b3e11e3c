"""What all screens of review share: the session, the posture and mode looked at, results."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from armodal.analyzer.modal import ModalModel
from armodal.tui.screens.review.posture_view import OpenSession, PostureView

__all__ = ["ReviewState"]


@dataclass(slots=True, kw_only=True)
class ReviewState:
    """Changed by the app alone; screens read it when they paint."""

    opened: OpenSession
    views: list[PostureView]
    posture: int = 0
    mode: int = 0
    unsaved: bool = False
    identification: dict[str, Any] | None = None
    gap: dict[str, Any] | None = None
    messages: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, opened: OpenSession) -> ReviewState:
        """State at the first posture."""
        return cls(opened=opened, views=list(opened.views))

    def renew(self, opened: OpenSession) -> None:
        """Take a session that went on, and stay at the posture looked at."""
        name = self.view.name
        self.opened, self.views = opened, list(opened.views)
        names = [view.name for view in self.views]
        self.posture = names.index(name) if name in names else 0
        self.choose_mode(min(self.mode, max(self.n_modes - 1, 0)))

    @property
    def view(self) -> PostureView:
        """The posture looked at."""
        return self.views[self.posture]

    @property
    def model(self) -> ModalModel | None:
        """Its modes, when fitted."""
        return self.view.model

    @property
    def n_modes(self) -> int:
        """How many modes the posture looked at has."""
        return 0 if self.model is None else len(self.model.modes)

    def choose_posture(self, step: int) -> None:
        """Go to a neighbouring posture, round the ends."""
        self.posture = (self.posture + step) % len(self.views)
        self.mode = min(self.mode, max(self.n_modes - 1, 0))

    def choose_mode(self, mode: int) -> None:
        """Look at a mode, round the ends."""
        self.mode = mode % self.n_modes if self.n_modes else 0

    def status(self) -> str:
        """One line: arm, posture, modes, losses, what is not saved."""
        view, session = self.view, self.opened.session
        if view.problem:
            modes = "no modes"
        elif view.model is None:
            modes = "fitting…"
        else:
            modes = f"{self.n_modes} modes {'by hand' if view.by_hand else 'automatic'}"
        parts = [
            session.header.arm.name,
            f"posture {self.posture + 1}/{len(self.views)} {view.name}",
            modes,
        ]
        if not session.complete:
            parts.append("session not complete")
        if view.changed:
            parts.append("PICKS NOT REFITTED (r)")
        if self.unsaved:
            parts.append("PICKS NOT SAVED (s)")
        return " · ".join([*parts, self.opened.lost])
