"""Fault matrix: small sessions under seeded faults, each held against the laboratory's ledger.

The invariant, for every seed: what was accepted is in the ledger, byte for byte; every missing
sample is reported; none is invented; the session goes on, or stops with the reason. Runs are in
this process on a virtual clock, each a few lab seconds long, resumed wherever it fails; every
kind of fault in turn, half of the runs with two at once. With --pty, a sample of them on real
pseudo-terminals with the laboratory as a process, at 16 times the clock.

    python bench/torture_faults.py [--runs 600] [--first 0] [--pty 16]

Exit code 1 if any run violates the invariant, or if fewer were made than are wanted; a seed repeats
its run exactly.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

from figures import Figure, told

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.fault_runs import MATRIX, run_seed, script_of
from support.fault_runs_pty import PTY_MATRIX, run_on_ptys


def kinds_of(seed: int) -> set[str]:
    scripted, at_blows = script_of(seed)
    return {name.partition("@")[0] for name in scripted} | {fault for _, fault, _, _ in at_blows}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=600)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--pty", type=int, default=len(PTY_MATRIX))
    given = parser.parse_args()
    begun, bad, bad_on_ptys = time.monotonic(), 0, 0
    counts: Counter[str] = Counter()
    kinds: Counter[str] = Counter()
    for seed in range(given.first, given.first + given.runs):
        outcome = run_seed(seed)
        counts += outcome.counts
        kinds.update(kinds_of(seed))
        for violation in outcome.violations:
            print(f"seed {seed}, {outcome.faults}: {violation}", flush=True)
        bad += bool(outcome.violations)
    print(f"{given.runs} runs of {len(MATRIX)} kinds of fault, {bad} with a violation")
    print("  " + ", ".join(f"{kind} {n}" for kind, n in sorted(kinds.items())))
    print("  " + ", ".join(f"{what} {n}" for what, n in sorted(counts.items())))
    print(f"  {time.monotonic() - begun:.0f} s")
    for number in range(given.pty):
        violations, what = run_on_ptys(number)
        print(f"pty run {number}, {what}: {'; '.join(violations) or 'no violation'}", flush=True)
        bad_on_ptys += bool(violations)
    return told(
        [
            Figure("seeded fault runs", str(given.runs), "500", given.runs >= 500),
            Figure("... kinds of fault, in half of the runs two at once", str(len(kinds)),
                   str(len(MATRIX)), len(kinds) >= len(MATRIX)),
            Figure("... with the invariant violated", str(bad), "0", not bad),
            Figure("... the same on pseudo-terminals, out of "
                   f"{given.pty} runs", str(bad_on_ptys), "0", not bad_on_ptys),
        ]
    )  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
