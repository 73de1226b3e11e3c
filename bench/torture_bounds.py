"""Give every decoder of files all that was made to take its memory and time.

    python bench/torture_bounds.py [NAME ...]

Files come from `tests/support/bombs.py`. One of 1 MB may take 200 MB, one of 100 MB may take 1 GB
and ten seconds of a processor.
"""

from __future__ import annotations

import sys
from pathlib import Path

from figures import Figure, told

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import support.bombs_of_others  # noqa: F401 - adds to them
from support.accepted_hits import quick_folder
from support.bombs import BOMBS
from support.bounded import wrong_with


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
    return told(
        [
            Figure("files made to take much, decoder by decoder", str(tried), "1", tried > 0),
            Figure("... beyond their bounds of memory and time", str(wrong), "0", wrong == 0),
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
