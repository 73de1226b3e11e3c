"""The hits that a session has taken: their numbers, which were accepted, the hammer's polarity."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from armodal.daq.hammer_polarity import HammerPolarity
from armodal.protocols.plan_records import Plan
from armodal.protocols.session.progress import roving_point
from armodal.protocols.session.records import Hit

__all__ = ["HitTally"]


class HitTally:
    """Counts hits, and remembers the accepted ones so that the last can be taken back.

    Attributes
    ----------
    next_number
        Of the next hit.
    accepted, rejected
        Since the session was begun or gone on with.
    """

    def __init__(
        self,
        plan: Plan,
        next_number: int,
        accepted_before: Sequence[tuple[int, str, str]],
        polarities_before: Mapping[int, int] | None,
    ) -> None:
        self._plan = plan
        self.next_number = next_number
        self.accepted = self.rejected = 0
        # Number, posture and roving point of every accepted hit, the last one at the end.
        self._kept = list(accepted_before)
        self._polarity = HammerPolarity(polarities_before)

    @property
    def polarity(self) -> int | None:
        """Sign of the hammer's channel that accepted hits have told."""
        return self._polarity.known

    def points(self) -> Iterator[str]:
        """Roving points of accepted hits."""
        return (point for _, _, point in self._kept)

    def keep(self, hit: Hit) -> bool:
        """Count a hit; return whether it tells that the hammer is turned round."""
        verdict = hit.verdict
        self.next_number += 1
        self.accepted += verdict.accepted
        self.rejected += not verdict.accepted
        if not verdict.accepted:
            return False
        self._kept.append((hit.number, hit.posture, roving_point(self._plan, hit)))
        return self._polarity.keep(hit.number, verdict.polarity)

    def take_back(self) -> tuple[int, str, str] | None:
        """Take the last accepted hit back; number, posture and roving point, None without one."""
        if not self._kept:
            return None
        taken = self._kept.pop()
        self._polarity.drop(taken[0])
        self.accepted -= 1
        self.rejected += 1
        return taken
