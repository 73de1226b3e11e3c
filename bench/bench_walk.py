"""How far it is by keys alone: from `armodal` to the first accepted hit, and from the last hit on.

Somebody who only does what the screens say walks from the home screen through a session in the
simulated laboratory, in real time, to its report: four postures, six points, two hits.

    python bench/bench_walk.py
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.walk import home_in, small_plan, walk_to_the_report

PLAN = "small.toml"


def main() -> int:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        small_plan(folder / PLAN, postures=4, hits=2)
        with home_in(folder) as terminal:
            found = asdict(walk_to_the_report(terminal, PLAN))
    found["keys_to_first_accepted"] -= len(PLAN)  # none is typed for the plan that is offered
    rounded = {key: round(value, 1) for key, value in found.items()}
    print(json.dumps(rounded | {"load_average": os.getloadavg()[0]}, indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
