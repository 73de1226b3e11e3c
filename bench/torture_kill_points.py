"""Kill a session at every change of its files.

Before and after every create, write, sync, cut, renaming and removal, and within every write at
up to 75 places, the disk is laid out as a kill there leaves it: everything done, and a part of the
write. From there the session file is recovered, and the session resumed.

    python bench/torture_kill_points.py [seed]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from figures import Figure, told
from recorded_session import recorded, tried

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.recorded_disk import kill_points

PLACES = 75


def main() -> int:
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    with tempfile.TemporaryDirectory() as folder:
        log = recorded(seed, Path(folder)).log
    kinds = [change.kind for change in log]
    print(", ".join(f"{kinds.count(kind)} {kind}" for kind in sorted(set(kinds))))
    n_hits = len({hit.number for change in log for hit in change.hits})
    points = kill_points(log, np.random.default_rng(seed), places=PLACES)
    kills, wrong = tried(points, "kill points")
    return told(
        [
            Figure("accepted hits in the recorded session", str(n_hits), "15", n_hits >= 15),
            Figure("kill points in the file layer", str(kills), "2000", kills >= 2000),
            Figure("... with an accepted hit lost or altered", str(len(wrong)), "0", not wrong),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
