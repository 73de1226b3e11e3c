"""Cut the power wherever something of a session is not synced yet.

What was synced is there. Of the rest every sector, of 512 B or 4 KiB, shows any version it had
since the sync, zeros, or bytes nobody wrote; lengths and names are each old or new, in any order
(`tests/support/recorded_disk.py`). From there the session file is recovered, and the session
resumed.

    python bench/torture_power_cuts.py [seed] [replays]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from figures import Figure, told
from recorded_session import recorded, tried

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.recorded_disk import power_cuts

WANTED = 5000


def main() -> int:
    numbers = [int(argument) for argument in sys.argv[1:]]
    seed, wanted = (*numbers, *(1, WANTED)[len(numbers) :])
    rng = np.random.default_rng(seed)
    with tempfile.TemporaryDirectory() as folder:
        log = recorded(seed, Path(folder)).log
    n_synced = sum(1 for _ in power_cuts(log, rng, each=0))
    n_unsynced = sum(1 for _ in power_cuts(log, rng, each=1)) - n_synced
    each = -(-(wanted - n_synced) // n_unsynced)
    cuts, wrong = tried(power_cuts(log, rng, each=each), "power cuts")
    return told(
        [
            Figure("sector replays of power cuts", str(cuts), str(wanted), cuts >= wanted),
            Figure("... with an accepted hit lost or altered", str(len(wrong)), "0", not wrong),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
