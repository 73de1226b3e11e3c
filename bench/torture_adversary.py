"""Disturb sessions in every way there is and look for the hits that were announced.

    python bench/torture_adversary.py [--runs 1040] [--first 0]

Somebody removes, moves, replaces, cuts, empties, holes or writes to the journal, or its folder, or
its lock; the disk turns read-only, withdraws permission, is full, tells errors late; the computer
stops or sleeps; the board reboots in any state, its clock jumps, angles grow stale. Each at another
moment, three in ten with a mirror (`tests/support/adversary.py`).
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from operator import itemgetter
from pathlib import Path

from figures import Figure, told

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.adversary import KINDS, disturbed_session

WANTED = 1000
WANTED_OF_A_WAY = 30
RUNS = 40 * len(KINDS)  # of each way; some come to their end undisturbed


def main() -> int:
    """Disturb one session after the other; print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    announced, lost, loose = 0, 0, 0
    ended: Counter[str] = Counter()
    struck = Counter(dict.fromkeys(KINDS, 0))
    for seed in range(given.first, given.first + given.runs):
        found = disturbed_session(seed)
        announced += found.announced
        if seed % 100 == 99:
            print(f"{seed + 1 - given.first} sessions, {announced} hits announced", flush=True)
        struck[found.kind] += found.struck
        lost += len(found.lost)
        ended[found.endings[-1].partition(":")[0]] += 1
        if found.lost or found.wrong:
            loose += bool(found.wrong)
            print(f"seed {seed}, {found.kind}: lost {found.lost} {found.wrong}", flush=True)
            print(f"  {'; '.join(found.endings)}", flush=True)
    print(", ".join(f"{what} {n}" for what, n in sorted(ended.items())), flush=True)
    print(", ".join(f"{what} {n}" for what, n in struck.items()), flush=True)
    least, fewest = min(struck.items(), key=itemgetter(1))
    return told(
        [
            Figure(f"disturbed sessions, {len(KINDS)} ways", str(given.runs), str(WANTED),
                   given.runs >= WANTED),
            Figure(f"... of the way that came about least ({least})", str(fewest),
                   str(WANTED_OF_A_WAY), fewest >= WANTED_OF_A_WAY),
            Figure("... hits announced in them", str(announced), "1", announced > 0),
            Figure("... of these lost", str(lost), "0", lost == 0),
            Figure("... sessions whose files others may read", str(loose), "0", loose == 0),
        ]
    )  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
