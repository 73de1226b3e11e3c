"""Soak of a whole day: 24 hours of samples as fast as they are decoded, in memory that stays flat.

    python bench/torture_day_soak.py [--hours 24]

A device of four channels at 25.6 kS/s samples noise, and a hit every two minutes; the clock passes
as the samples do (`tests/support/day_session.py`). Every sample goes through the device library,
the frame decoder and the count of what was lost; every hit is judged and kept. What the process
holds is looked at after every tenth of the day. The journal is held in memory, so that it can be
rescued: so much may come to it.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from figures import Figure, told

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.day_session import RATE_HZ, run_day

HOURS = 24.0
WANTED = 2_000_000_000
FLAT_BYTES = 8 * 2**20  # pages that the allocator may come to hold beside the journal


def main() -> int:
    """Sample for a day; print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hours", type=float, default=HOURS)
    given = parser.parse_args()
    begun_s = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        day = run_day(Path(folder), 3600.0 * given.hours)
    took_s = time.process_time() - begun_s
    if day.failed:
        return told([Figure("soak of a day", day.failed, "to its end", False)])
    print("MB held after each tenth:", ", ".join(f"{size / 1e6:.1f}" for size in day.memory))
    print(f"{took_s:.0f} s of processor time, {day.taken / took_s / 1e6:.2f} million samples/s")
    print(f"{day.previews} previews, a journal of {day.journal_bytes / 1e6:.1f} MB")
    first, last = day.memory[0] / 1e6, day.memory[-1] / 1e6
    flat = day.grown <= FLAT_BYTES + day.journal_bytes
    wrong = len(day.lost) + len(day.altered)
    return told(
        [
            Figure(
                f"soak of {given.hours:g} h at 4 x {RATE_HZ / 1000:g} kS/s on the virtual clock, "
                "samples",
                f"{day.taken:,}",
                f"{WANTED:,}",
                day.taken >= WANTED,
            ),
            Figure(
                f"... not accounted for, {day.missing:,} reported missing",
                f"{day.unexplained:,}",
                "0",
                day.unexplained == 0,
            ),
            Figure(
                f"... hits lost or altered, of {day.announced} announced, {day.kept} kept",
                str(wrong),
                "0",
                wrong == 0 and day.announced == day.kept > 0,
            ),
            Figure(
                "... MB held after a tenth and at the end",
                f"{first:.1f}, {last:.1f}",
                f"{(FLAT_BYTES + day.journal_bytes) / 1e6:.1f} more at most",
                flat,
            ),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
