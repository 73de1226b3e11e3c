"""Events on their way to a listener who may be slow, or gone.

Whoever puts an event in never waits. Previews replace one another; states queue, within bounds.
A thread of its own does the sending: it may block in the pipe, the acquisition loop may not.
"""

from __future__ import annotations

import threading
from collections import deque
from multiprocessing.connection import Connection
from typing import Any

from armodal.daq.events import Event, is_preview

__all__ = ["Outbox"]


class Outbox:
    """A bounded queue of events in front of a connection.

    Attributes
    ----------
    previews_dropped : int
        Previews that a later one replaced before they were sent.
    states_dropped : int
        Other events that found the queue full; the oldest go first.
    closed : bool
        Whether the listener is gone.
    """

    def __init__(self, channel: Connection[Any, Any], *, room: int = 1024) -> None:
        self._channel = channel
        self._states: deque[Event] = deque()
        self._previews: dict[type, Event] = {}
        self._room = room
        self._changed = threading.Condition()
        self._finishing = False
        self.previews_dropped = 0
        self.states_dropped = 0
        self.closed = False
        self._thread = threading.Thread(target=self._send_all, name="outbox", daemon=True)
        self._thread.start()

    def put(self, event: Event) -> None:
        """Take an event to be sent; returns at once."""
        with self._changed:
            if is_preview(event):
                self.previews_dropped += type(event) in self._previews
                self._previews[type(event)] = event
            else:
                if len(self._states) >= self._room:
                    self._states.popleft()
                    self.states_dropped += 1
                self._states.append(event)
            self._changed.notify()

    def finish(self, timeout_s: float) -> bool:
        """Send what is queued, for at most so many wall seconds; False if some was left."""
        with self._changed:
            self._finishing = True
            self._changed.notify()
        self._thread.join(timeout_s)
        return not self._thread.is_alive() and not self.closed

    def _send_all(self) -> None:
        while (event := self._take()) is not None:
            try:
                self._channel.send(event)
            except (OSError, ValueError):
                self.closed = True
                return

    def _take(self) -> Event | None:
        with self._changed:
            while not (self._states or self._previews or self._finishing):
                self._changed.wait()
            if self._states:
                return self._states.popleft()
            if self._previews:
                return self._previews.pop(next(iter(self._previews)))
            return None
