from __future__ import annotations

import multiprocessing
import threading
import time

from armodal.daq.events import Failed, JointsSeen, Noted
from armodal.daq.outbox import Outbox
from armodal.protocols.session.records import JointReading


def note(k: int) -> Noted:
    # Large enough that a pipe holds only a few.
    return Noted(text="x" * 20_000, host_s=float(k))


def joints(k: int) -> JointsSeen:
    reading = JointReading(joints_rad=None, drive_state=None, held=False, age_s=0.0, host_s=k)
    return JointsSeen(reading=reading)


def test_events_arrive_in_order():
    ours, theirs = multiprocessing.Pipe()
    outbox = Outbox(theirs)
    for k in range(3):
        outbox.put(note(k))
    assert [ours.recv().host_s for _ in range(3)] == [0.0, 1.0, 2.0]
    assert outbox.finish(5.0)
    ours.close()
    theirs.close()


def test_a_listener_who_never_listens_holds_nobody_up_and_memory_stays_bounded():
    ours, theirs = multiprocessing.Pipe()
    outbox = Outbox(theirs, room=16)
    begun = time.monotonic()
    for k in range(5000):
        outbox.put(note(k))
        outbox.put(joints(k))
    outbox.put(Failed(message="the last word", kind="Error", journal=None))
    assert time.monotonic() - begun < 2.0
    assert outbox.states_dropped > 4900
    assert outbox.previews_dropped > 4900
    received: list[object] = []

    def listen() -> None:
        while not (received and isinstance(received[-1], Failed)):
            received.append(ours.recv())

    listener = threading.Thread(target=listen)
    listener.start()
    assert outbox.finish(5.0)
    listener.join(5.0)
    states = [e.host_s for e in received if isinstance(e, Noted)]
    assert states == sorted(states)
    ours.close()
    theirs.close()


def test_a_listener_who_has_gone_is_noticed():
    ours, theirs = multiprocessing.Pipe()
    outbox = Outbox(theirs)
    ours.close()
    outbox.put(note(1))
    assert not outbox.finish(5.0)
    assert outbox.closed
    theirs.close()
