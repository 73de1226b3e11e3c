"""Journals damaged in known ways: of each it is known which records are still whole."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from armodal.protocols.session.journal import MAGIC, begin_journal, encode_hit
from armodal.protocols.session.records import Hit, SessionHeader


@dataclass(frozen=True)
class Damaged:
    """A journal's bytes, and the records that are whole in it, as they were written."""

    data: bytes
    whole: tuple[bytes, ...]


def _torn(record: bytes, rng: np.random.Generator) -> bytes:
    return record[: rng.integers(1, len(record))]


def _beheaded(record: bytes, rng: np.random.Generator) -> bytes:
    return record[rng.integers(1, len(record)) :]


def _flipped(record: bytes, rng: np.random.Generator) -> bytes:
    changed = bytearray(record)
    changed[rng.integers(len(record))] ^= 1 << int(rng.integers(8))
    return bytes(changed)


def _zeroed(record: bytes, rng: np.random.Generator) -> bytes:
    begin, end = sorted(rng.integers(0, len(record) + 1, 2).tolist())
    return record[:begin] + bytes(end - begin) + record[end:] if end - begin > 8 else b""


def _gone(_record: bytes, _rng: np.random.Generator) -> bytes:
    return b""


def _long(record: bytes, _rng: np.random.Generator) -> bytes:
    return (60_000_000).to_bytes(4, "little") + record[4:]


_DAMAGE = (_torn, _beheaded, _flipped, _zeroed, _gone, _long)


def damaged(
    records: Sequence[bytes], rng: np.random.Generator, *, header_too: bool = False
) -> Damaged:
    """Damage some of a journal's records and put holes and other bytes between them.

    Parameters
    ----------
    records
        Without the magic; the first is HEADER, which stays unless `header_too`.
    """
    share = rng.uniform(0.05, 0.7)
    parts = [MAGIC if rng.random() < 0.8 else rng.bytes(int(rng.integers(0, 20)))]
    whole = []
    for index, record in enumerate(records):
        hurt = rng.random() < share and (index > 0 or header_too)
        changed = _DAMAGE[rng.integers(len(_DAMAGE))](record, rng) if hurt else record
        if changed == record:
            whole.append(record)
        parts.append(changed)
        between = rng.random()
        if between < 0.1:
            parts.append(bytes(int(rng.integers(1, 10_000))))
        elif between < 0.2:
            parts.append(rng.bytes(int(rng.integers(1, 3000))))
        elif between < 0.25:
            parts.append(b"RJ" * int(rng.integers(1, 500)))
        elif between < 0.3:
            parts.append(records[rng.integers(len(records))][:-6])
    return Damaged(b"".join(parts), tuple(whole))


def run_of(
    header: SessionHeader,
    hits: Sequence[Hit],
    *,
    session_id: str,
    start_s: float,
    late_s: float = 0.0,
) -> list[bytes]:
    """Return HEADER and HIT records of a session whose board was started at `start_s`.

    The computer's clock is read up to `late_s` late: at every other hit.
    """
    rate = float(header.plan.sampling.rate_hz) * header.time_scale
    head = begin_journal(replace(header, session_id=session_id))[len(MAGIC) :]
    return [
        head,
        *(
            encode_hit(replace(hit, trigger_host_s=start_s + hit.trigger_sample / rate + late))
            for hit, late in zip(hits, itertools.cycle([0.0, late_s]), strict=False)
        ),
    ]


def mixed(one: Sequence[bytes], other: Sequence[bytes], rng: np.random.Generator) -> list[bytes]:
    """Return two journals' records in one order, each journal's own kept.

    The first one's HEADER and a hit of it stand before all of the other's.
    """
    parts = [[*one[2:]], [*other]]
    found = [*one[:2]]
    while parts[0] or parts[1]:
        which = int(rng.random() < 0.5)
        if parts[which]:
            found.append(parts[which].pop(0))
    return found
