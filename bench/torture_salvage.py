"""Salvage damaged journals: every record that is whole must come back, in its order.

    python bench/torture_salvage.py [--journals 5000] [--seed 1]

A journal is torn, cut, zeroed, changed bit by bit, holed and filled with other bytes; one in four
lost its HEADER too, one in four holds two sessions at once, mixed record by record.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
from figures import Figure, told

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.damaged_journals import Damaged, damaged, mixed, run_of
from support.fault_runs import run_seed

from armodal.protocols.errors import ArmodalError
from armodal.protocols.session.journal import decode_journal
from armodal.protocols.session.journal_bytes import InMemory
from armodal.protocols.session.records import Hit, SessionHeader
from armodal.protocols.session.salvage import salvage

WANTED = 5000
_MOST_HITS = 12


def case_of(
    header: SessionHeader, hits: list[Hit], number: int, rng: np.random.Generator
) -> tuple[Damaged, list[list[bytes]]]:
    """Return a damaged journal, and the whole records of each session in it."""
    n = int(rng.integers(2, _MOST_HITS))
    one = run_of(header, hits[:n], session_id="aa", start_s=float(rng.uniform(0, 1e5)))
    if number % 4 != 3:
        case = damaged(one, rng, header_too=number % 4 == 2)
        return case, [list(case.whole)]
    other = run_of(
        header, hits[: n // 2 + 1], session_id="bb", start_s=float(rng.uniform(2e5, 3e5))
    )
    case = damaged(mixed(one, other, rng), rng)
    return case, [[r for r in case.whole if r in part] for part in (one, other)]


def wrong(header: SessionHeader, case: Damaged, wanted: list[list[bytes]]) -> tuple[str, int]:
    """Return what salvage did wrong with a journal, if anything, and how many records it took."""
    try:
        found = salvage(InMemory(case.data), header=header)
        journals = [b"".join(session.parts()) for session in found.sessions]
        for journal in journals:
            decode_journal(journal)
    except ArmodalError as error:
        return str(error), 0
    if len(found.sessions) < len(wanted) or (len(wanted) == 2 and case.whole[1] not in wanted[0]):
        # A HEADER is lost, or both stand before all hits: nothing tells whose these are.
        lost = len(case.whole) - found.taken
    else:
        pairs = zip(journals, wanted, strict=True)
        lost = sum(not journal.endswith(b"".join(part)) for journal, part in pairs)
    return (
        "" if not lost else f"{lost} of {len(case.whole)} whole records or sessions"
    ), found.taken


def main() -> int:
    """Damage and salvage; print the figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--journals", type=int, default=WANTED)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    count: Counter[str] = Counter()
    session = decode_journal(run_seed(0, script=((), ())).journal)
    hits = [replace(session.hits[i % len(session.hits)], number=i + 1) for i in range(_MOST_HITS)]
    for number in range(args.journals):
        rng = np.random.default_rng((args.seed, number))
        case, wanted = case_of(session.header, hits, number, rng)
        said, taken = wrong(session.header, case, wanted)
        count["whole"] += len(case.whole)
        count["taken"] += taken
        if said:
            count["wrong"] += 1
            print(f"seed {args.seed}, journal {number}: {said}", flush=True)
    return told(
        [
            Figure(
                "damaged journals salvaged",
                str(args.journals),
                str(WANTED),
                args.journals >= WANTED,
            ),
            Figure("... whole records in them", str(count["whole"]), "1", count["whole"] > 0),
            Figure(
                "... journals with one lost or out of place",
                str(count["wrong"]),
                "0",
                not count["wrong"],
            ),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
