"""Write what is made from the table of messages.

python -m armodal.protocols.board.generate           writes all
python -m armodal.protocols.board.generate --check   exit code 1 if a file is not what it writes
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from armodal.protocols.board.generate import (
    TABLE,
    c_board_source,
    c_header,
    c_host_source,
    document_with_tables,
    field_vectors,
)

__all__ = ["main"]

ROOT = Path(__file__).resolve().parents[3]
DOCUMENT = ROOT / "docs" / "board-protocol.md"


def wanted() -> dict[Path, str]:
    """Text of each file that is made."""
    c = ROOT / "protocols" / "c"
    return {
        c / "include" / "armodal_messages.h": c_header(TABLE),
        c / "src" / "messages.c": c_board_source(TABLE),
        c / "src" / "host_messages.c": c_host_source(TABLE),
        DOCUMENT: document_with_tables(DOCUMENT.read_text(encoding="utf-8"), TABLE),
        ROOT / "tests" / "vectors" / "board-fields-v1.json": field_vectors(TABLE),
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the files, or with `--check` name those that are not what would be written."""
    parser = argparse.ArgumentParser(prog="armodal.protocols.board.generate")
    parser.add_argument("--check", action="store_true", help="write nothing")
    given = parser.parse_args(arguments)
    if not DOCUMENT.is_file():
        sys.stderr.write(f"{DOCUMENT} is not there: run this in a checkout of the sources\n")
        return 2
    stale = {
        path: text
        for path, text in wanted().items()
        if not path.is_file() or path.read_text(encoding="utf-8") != text
    }
    for path, text in stale.items():
        if not given.check:
            path.write_text(text, encoding="utf-8")
        sys.stdout.write(f"{path.relative_to(ROOT)} {'is stale' if given.check else 'written'}\n")
    return int(given.check and bool(stale))


if __name__ == "__main__":
    sys.exit(main())
