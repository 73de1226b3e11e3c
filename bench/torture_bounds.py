"""Give every decoder of files all that was made to take its memory and time.

    python bench/torture_bounds.py [NAME ...]

Files come from `tests/support/bombs.py`. One of 1 MB may take 200 MB, one of 100 MB may take 1 GB
and ten seconds of a processor. HDF5 files of which one length is told wrong, each of those they
tell, and COLLADA and PLY files made wrong go the same way. With NAMEs only these files.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from figures import Figure, told

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import support.bombs_of_hdf5
import support.bombs_of_others  # noqa: F401 - adds to them
from support.accepted_hits import quick_folder
from support.bombs import BOMBS
from support.bombs_of_hdf5 import LONG, with_false_lengths
from support.bounded import wrong_with
from support.changed_meshes import changed_meshes
from support.fuzz_material import decoders_in

LENGTHS = (LONG // 4, LONG, 2 * LONG, 2**32 - 1)  # bytes
WANTED_LENGTHS = 300
MESHES = 50  # of either kind


def told_falsely(folder: str) -> Iterator[tuple[str, str, bytes]]:
    """Yield decoder, ending and bytes of HDF5 files, each with one length told wrong."""
    decoders = decoders_in(folder)
    for name, decoder, ending in (("hdf5", "session", ".h5"), ("nc4", "content", ".nc4")):
        for seed in decoders[name].seeds:
            for length in LENGTHS:
                for data in with_false_lengths(seed, length):
                    yield decoder, ending, data


def faults(files: Iterator[tuple[str, str, bytes]], folder: str) -> tuple[int, int]:
    """Give files to their decoders; return how many there were, and how many went beyond."""
    tried, wrong = 0, 0
    for decoder, ending, data in files:
        path = Path(folder) / f"false{ending}"
        path.write_bytes(data)
        tried += 1
        if said := wrong_with(decoder, path):
            wrong += 1
            print(f"{ending}, number {tried}: {said}", flush=True)
    return tried, wrong


def main() -> int:
    """Make each file, give it to its decoders, and print the figures."""
    tried, wrong = 0, 0
    wanted = sys.argv[1:] or list(BOMBS)
    with quick_folder() as folder:
        for name in wanted:
            decoders, ending, make = BOMBS[name]
            path = Path(folder) / f"bomb{ending}"
            make(path)
            for decoder in decoders:
                tried += 1
                if said := wrong_with(decoder, path):
                    wrong += 1
                    print(f"{name}: {said}", flush=True)
            path.unlink()
        figures = [
            Figure("files made to take much, decoder by decoder", str(tried), "1", tried > 0),
            Figure("... beyond their bounds of memory and time", str(wrong), "0", wrong == 0),
        ]
        if not sys.argv[1:]:
            figures += others(str(folder))
    return told(figures)


def others(folder: str) -> list[Figure]:
    """Give the decoders files made wrong one by one."""
    lengths, beyond = faults(told_falsely(folder), folder)
    changed = changed_meshes(MESHES, np.random.default_rng(1))
    meshes, unread = faults((("mesh", ending, data) for ending, data in changed), folder)
    enough = lengths >= WANTED_LENGTHS
    return [
        Figure("HDF5 files with a length told wrong", str(lengths), str(WANTED_LENGTHS), enough),
        Figure("... beyond their bounds", str(beyond), "0", beyond == 0),
        Figure("COLLADA and PLY files made wrong", str(meshes), str(2 * MESHES), meshes > 0),
        Figure("... beyond their bounds, or no sentence", str(unread), "0", unread == 0),
    ]


if __name__ == "__main__":
    sys.exit(main())
