"""Refuse every change of a session's files, once and for good: EIO, ENOSPC, read-only.

For every create, write, sync, cut, renaming and removal of a session that is recorded, and whose
session file is derived twice, the disk refuses that one, or that one and all later ones. Half of
a refused write has reached the file. The fault must be said, what was announced must still be
there, also after a power cut behind the fault, and the session must go on once the disk is
healthy.

    python bench/torture_disk_faults.py [seed]
"""

from __future__ import annotations

import dataclasses
import errno
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from figures import Figure, told
from recorded_session import recorded

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.accepted_hits import quick_folder
from support.faulty_disk import FaultyDisk, wrong_with_faulty_disk

from armodal.protocols.session.journal import load_journal

CODES = (errno.EIO, errno.ENOSPC, errno.EROFS)
HITS = 12


def main() -> int:
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    rng = np.random.default_rng(seed)
    count, wrong, began = 0, [], time.monotonic()
    with tempfile.TemporaryDirectory() as home, quick_folder() as faulty:
        recorded(seed, Path(home))
        session = load_journal(Path(home, "session.journal"))
        session = dataclasses.replace(session, hits=session.hits[:HITS])
        folder = Path(faulty)
        for lasting in (False, True):
            for code in CODES:
                at = 0
                while True:
                    disk = FaultyDisk(at, code, lasting=lasting)
                    said = wrong_with_faulty_disk(session, disk, folder, rng)
                    if not disk.refused:
                        break
                    if said is not None:
                        wrong.append(f"{errno.errorcode[code]} at {at}, {lasting=}: {said}")
                        print(wrong[-1], flush=True)
                    at += 1
                    count += 1
                print(f"{count} in {time.monotonic() - began:.0f} s", flush=True)
    return told(
        [
            Figure("disk faults (EIO, ENOSPC, read-only)", str(count), "200", count >= 200),
            Figure("... unsaid, with a hit lost, or no way back", str(len(wrong)), "0", not wrong),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
