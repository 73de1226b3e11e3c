"""Find the frames a link lost by their sequence numbers."""

from __future__ import annotations

from armodal.protocols.board.records import Header

__all__ = ["SequenceTracker", "sequence_gap"]

_MODULUS = 1 << 32


def sequence_gap(expected: int, sequence: int) -> int:
    """Frames missing before `sequence`, over the wrap of the 32-bit counter.

    Negative where the frame is older than expected (sent twice, or a sender that began anew).

    >>> sequence_gap(7, 9)
    2
    >>> sequence_gap(0xFFFFFFFF, 1)
    2
    """
    gap = (sequence - expected) % _MODULUS
    return gap if gap < _MODULUS // 2 else gap - _MODULUS


class SequenceTracker:
    """Count what is missing in the frames of one sender.

    Attributes
    ----------
    missing : int
        Frames that never came.
    disordered : int
        Frames that came with a number already passed.
    """

    def __init__(self) -> None:
        self.missing = 0
        self.disordered = 0
        self._session: int | None = None
        self._expected = 0

    def check(self, header: Header) -> int:
        """Take in a header; return the frames missing before it, negative if it is an old one.

        The first frame, and the first of another session, only sets what is expected next.
        """
        gap = 0
        if header.session == self._session:
            if header.sequence == self._expected:
                self._expected = (self._expected + 1) % _MODULUS
                return 0
            gap = sequence_gap(self._expected, header.sequence)
            self.missing += max(gap, 0)
            self.disordered += gap < 0
        self._session = header.session
        if gap >= 0:
            self._expected = (header.sequence + 1) % _MODULUS
        return gap
