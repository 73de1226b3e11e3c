"""Processor time of making cases, by maker, and whether their sizes are met.

    python bench/bench_makers.py ur10e kr210

Wanted: a case in five seconds; hits that are simulated in time, of bent laws alone, take longer.
"""

from __future__ import annotations

import json
import sys
import time

from armodal.hil_sim.makers import MAKERS, effects_of, make_case

SEEN = ("stands_out", "visible")


def timed(maker: str, arm: str, effect: str | None) -> str:
    """One line of the table."""
    wrist = "rigid" if effect == "released_joint" else "elastic"
    start = time.process_time()
    case = make_case(maker, 1, arm, effect, wrist=wrist)
    made = time.process_time()
    case.session()
    measured = time.process_time()
    effects = json.loads(case.open_truth())["effects"]
    seen = [effect[key] for effect in effects for key in SEEN if key in effect]
    stands = f"{seen[0]:8.2f}" if seen else 8 * " "
    name = effect or "null"
    return f"{maker:8} {arm:12} {name:22} {made - start:6.1f} {measured - made:6.1f} {stands}"


if __name__ == "__main__":
    print("maker    arm          effect                   made measured  stands out")
    for maker in MAKERS:
        for arm in sys.argv[1:] or ["lrmate200id"]:
            for effect in (None, *effects_of(maker)):
                print(timed(maker, arm, effect), flush=True)
