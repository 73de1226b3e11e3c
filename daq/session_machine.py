"""What comes next: plan, postures, points and hits as a state that never changes in place.

A state says by itself what to ask of the operator:

* the arm is not at the posture: ask for it;
* the point is not ready: ask for sensor and hammer;
* else ask for a hit, until the point has its accepted ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from armodal.protocols.plan_records import Mode, Plan, PlannedPosture
from armodal.protocols.session.journal_payloads import Mark
from armodal.protocols.session.progress import accepted_counts, roving_point
from armodal.protocols.session.records import Hit
from armodal.protocols.session.steps import place_in_hand, skipped_points

__all__ = [
    "Progress",
    "Prompt",
    "PromptKind",
    "SessionState",
    "begin",
    "hit_judged",
    "point_ready",
    "posture_left",
    "posture_reached",
    "retake",
    "skip",
    "withdraw",
]


class PromptKind(StrEnum):
    """What is asked of the operator."""

    POSTURE = "posture"  # bring the arm there
    POINT = "point"  # put sensor and hammer there, and say so
    HIT = "hit"
    DONE = "done"


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """How far one planned point of one posture is."""

    posture: str
    point: str
    wanted: int
    accepted: int = 0
    attempts: int = 0  # hits tried since the point was begun or retaken
    skipped: bool = False

    @property
    def complete(self) -> bool:
        """Whether nothing more is asked here, since it has its hits or was skipped."""
        return self.skipped or self.accepted >= self.wanted


@dataclass(frozen=True, slots=True, kw_only=True)
class Prompt:
    """What is asked now, with all a screen needs to ask it."""

    kind: PromptKind
    posture: PlannedPosture | None  # None when done
    sensor_point: str
    hit_point: str
    accepted: int
    wanted: int
    attempts: int
    exhausted: bool  # the plan's attempts are used up: retake, go on trying, or skip


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionState:
    """Where a session stands."""

    plan: Plan
    progress: tuple[Progress, ...]  # in the plan's order
    current: int | None  # index into progress; None when done
    at_posture: bool = False
    ready: bool = False

    @property
    def here(self) -> Progress | None:
        """The progress of the point in hand."""
        return None if self.current is None else self.progress[self.current]

    @property
    def lacking(self) -> int:
        """Planned points without their accepted hits, skipped ones too; as a session file counts.

        What a retake asks for beyond the plan is not among them.
        """
        return sum(p.accepted < self.plan.hits_per_point for p in self.progress)

    @property
    def kind(self) -> PromptKind:
        """What is asked now."""
        if self.current is None:
            return PromptKind.DONE
        if not self.at_posture:
            return PromptKind.POSTURE
        return PromptKind.HIT if self.ready else PromptKind.POINT

    @property
    def posture(self) -> PlannedPosture | None:
        """The posture in hand."""
        here = self.here
        if here is None:
            return None
        return next(p for p in self.plan.postures if p.name == here.posture)

    @property
    def prompt(self) -> Prompt:
        """What is asked now, in full."""
        here = self.here
        point = here.point if here else ""
        fixed = self.plan.fixed_point if here else ""
        roving_response = self.plan.mode is Mode.ROVING_RESPONSE
        return Prompt(
            kind=self.kind,
            posture=self.posture,
            sensor_point=point if roving_response else fixed,
            hit_point=fixed if roving_response else point,
            accepted=here.accepted if here else 0,
            wanted=here.wanted if here else 0,
            attempts=here.attempts if here else 0,
            exhausted=here is not None and here.attempts >= self.plan.max_attempts,
        )


def begin(plan: Plan, hits: Iterable[Hit] = (), marks: Sequence[Mark] = ()) -> SessionState:
    """Return the state at the beginning, or after hits and marks of an interrupted session.

    Points that were skipped stay so, as long as another one lacks hits; else they are asked for
    again. It goes on at the point that was begun last if that lacks hits, else at the point hit
    last, else at the first one that lacks some.
    """
    hits = tuple(hits)
    counts = accepted_counts(plan, hits)
    skipped = skipped_points(plan, hits, marks)
    progress = tuple(
        Progress(
            posture=posture.name,
            point=point,
            wanted=plan.hits_per_point,
            accepted=counts[posture.name, point],
            skipped=(posture.name, point) in skipped,
        )
        for posture in plan.postures
        for point in posture.points
    )
    state = SessionState(plan=plan, progress=progress, current=_next(progress))
    hit_last = (hits[-1].posture, roving_point(plan, hits[-1])) if hits else None
    for place in (place_in_hand(marks), hit_last):
        for i, here in enumerate(progress):
            if (here.posture, here.point) == place and not here.complete:
                return replace(state, current=i)
    return state


def posture_reached(state: SessionState) -> SessionState:
    """The arm is within tolerance of the posture, and still."""
    return replace(state, at_posture=True) if state.current is not None else state


def posture_left(state: SessionState) -> SessionState:
    """The arm is no longer there; what is mounted stays mounted."""
    return replace(state, at_posture=False)


def point_ready(state: SessionState) -> SessionState:
    """The operator says that sensor and hammer are at their points."""
    return replace(state, ready=True) if state.kind is PromptKind.POINT else state


def hit_judged(state: SessionState, *, accepted: bool) -> SessionState:
    """A hit at the point in hand was judged; goes on when the point has enough."""
    here = state.here
    if here is None:
        return state
    changed = replace(here, attempts=here.attempts + 1, accepted=here.accepted + accepted)
    return _advance(state, changed)


def skip(state: SessionState) -> SessionState:
    """Leave the point in hand without its hits."""
    here = state.here
    return state if here is None else _advance(state, replace(here, skipped=True))


def withdraw(state: SessionState, posture: str, point: str) -> SessionState:
    """Take back an accepted hit of a point, and ask for that point again.

    Raises
    ------
    KeyError
        If the plan has no such point.
    """
    index = _index(state, posture, point)
    chosen = state.progress[index]
    lacking = replace(chosen, accepted=max(chosen.accepted - 1, 0), skipped=False)
    here = state.here
    return replace(
        state,
        progress=(*state.progress[:index], lacking, *state.progress[index + 1 :]),
        current=index,
        at_posture=state.at_posture and here is not None and here.posture == posture,
        ready=state.ready and index == state.current,
    )


def retake(
    state: SessionState, posture: str | None = None, point: str | None = None
) -> SessionState:
    """Begin a point anew: the one in hand, or any other of the plan.

    Accepted hits are kept. A point that has all of them is given as many again; one that lacks
    some, or was skipped, is asked for what it lacks.

    Raises
    ------
    KeyError
        If the plan has no such point.
    """
    index = state.current
    if posture is not None or point is not None:
        index = _index(state, posture, point)
    if index is None:
        return state
    chosen = state.progress[index]
    wanted = chosen.wanted
    if chosen.accepted >= wanted:
        wanted = chosen.accepted + state.plan.hits_per_point
    renewed = replace(chosen, attempts=0, skipped=False, wanted=wanted)
    here = state.here
    return replace(
        state,
        progress=(*state.progress[:index], renewed, *state.progress[index + 1 :]),
        current=index,
        at_posture=state.at_posture and here is not None and here.posture == chosen.posture,
        ready=False,
    )


def _index(state: SessionState, posture: str | None, point: str | None) -> int:
    for i, p in enumerate(state.progress):
        if (p.posture, p.point) == (posture, point):
            return i
    raise KeyError(f"{posture}/{point}")


def _advance(state: SessionState, changed: Progress) -> SessionState:
    """Put the changed progress in, and go to the next point if this one is complete."""
    index = state.current
    if index is None:
        return state
    progress = (*state.progress[:index], changed, *state.progress[index + 1 :])
    if not changed.complete:
        return replace(state, progress=progress)
    following = _next(progress)
    same_posture = following is not None and progress[following].posture == changed.posture
    return replace(
        state,
        progress=progress,
        current=following,
        at_posture=state.at_posture and same_posture,
        ready=False,
    )


def _next(progress: tuple[Progress, ...]) -> int | None:
    return next((i for i, p in enumerate(progress) if not p.complete), None)
