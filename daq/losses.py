"""What did not arrive, gathered so that a bad line does not drown the journal."""

from __future__ import annotations

from armodal.protocols.session.records import Loss

__all__ = ["LossTally"]


class LossTally:
    """Count losses, and hand them on as few records.

    Losses of one kind and note between two calls of `take` become one record with their sum and
    the first sample index that any of them named.
    """

    def __init__(self) -> None:
        self._open: dict[tuple[str, str], Loss] = {}
        self._totals: dict[tuple[str, str], int] = {}

    def __len__(self) -> int:
        return len(self._open)

    def add(
        self, kind: str, count: int, note: str, host_s: float, first_sample: int | None = None
    ) -> None:
        """Note a loss; a count of nothing is none."""
        if count <= 0:
            return
        earlier = self._open.get((kind, note))
        if earlier is not None:
            count += earlier.count
            host_s = earlier.host_s
            first_sample = first_sample if earlier.first_sample is None else earlier.first_sample
        self._open[kind, note] = Loss(
            kind=kind, count=count, first_sample=first_sample, host_s=host_s, note=note
        )

    def watch(
        self, kind: str, total: int, note: str, host_s: float, first_sample: int | None = None
    ) -> None:
        """Note what a counter that only grows has grown by since it was last seen."""
        before = self._totals.get((kind, note), 0)
        self._totals[kind, note] = total
        self.add(kind, total - before, note, host_s, first_sample)

    def take(self) -> tuple[Loss, ...]:
        """Return what has gathered, and begin anew."""
        gathered = tuple(self._open.values())
        self._open.clear()
        return gathered
