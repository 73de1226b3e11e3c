"""Run every torture beside this file and put their figures into one table.

    make torture
    python bench/torture.py [--fresh] [NAME ...]

A torture is a script `torture_NAME.py` that ends with exit code 0 if all is as wanted. Rows
`| what | reached | wanted | good |` among its words (`figures.py`) come into the table.

One that went well at this commit is not run again: what it said is kept in `build/torture`, so that
an interrupted torture goes on where it was. `--fresh` runs all anew. The table, with date and
commit of each part, is written to `build/torture/table.md`.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
KEPT = HERE.parent / "build" / "torture"
HEAD = "| figure | reached | wanted | good | date | commit |\n|---|---|---|---|---|---|"
# Long studies of their own follow: as they take long, the short ones go first.
LAST = ("fuzz", "soak", "coverage")


def commit() -> str:
    """Return the commit that is tortured, with a sign where files differ from it."""
    said = subprocess.run(
        ["git", "describe", "--always", "--dirty", "--abbrev=9"],  # noqa: S607
        cwd=HERE, capture_output=True, text=True, check=False,
    )  # fmt: skip
    return said.stdout.strip() or "no commit"


def run(script: Path, at: str) -> dict[str, Any]:
    """Run one torture, its words passed on; return its rows and whether it went well."""
    name = script.stem.removeprefix("torture_")
    print(f"== {name}", flush=True)
    began = time.monotonic()
    process = subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True)
    rows = []
    for line in process.stdout or ():
        print(line, end="", flush=True)
        if line.startswith("| "):
            rows.append(line.rstrip())
    code = process.wait()
    print(f"== {name}: {time.monotonic() - began:.0f} s, exit code {code}", flush=True)
    if code != 0 or not rows:  # what it said without rows stands above the table
        rows.append(f"| {name} | exit code {code} | 0 | {'NO' if code else 'yes'} |")
    date = datetime.now(UTC).date().isoformat()
    return {"commit": at, "date": date, "good": code == 0, "rows": rows}


def kept_or_run(script: Path, at: str, *, fresh: bool) -> dict[str, Any]:
    """Return what a torture said at this commit, or run it."""
    path = KEPT / f"{script.stem}.json"
    if path.exists() and not fresh and not at.endswith("-dirty"):
        kept: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        if kept["commit"] == at and kept["good"]:
            print(f"== {script.stem.removeprefix('torture_')}: went well on {kept['date']}")
            return kept
    found = run(script, at)
    path.write_text(json.dumps(found), encoding="utf-8")
    return found


def main() -> int:
    """Run what is wanted, write the table."""
    wanted = [word for word in sys.argv[1:] if word != "--fresh"]
    scripts = sorted(HERE.glob("torture_*.py"), key=lambda path: (path.stem.endswith(LAST), path))
    scripts = [s for s in scripts if not wanted or s.stem.removeprefix("torture_") in wanted]
    if not scripts:
        print(f"no torture of that name: {', '.join(wanted)}")
        return 2
    KEPT.mkdir(parents=True, exist_ok=True)
    at = commit()
    results = [kept_or_run(script, at, fresh="--fresh" in sys.argv) for script in scripts]
    lines = [
        f"{row} {result['date']} | {result['commit']} |"
        for result in results
        for row in result["rows"]
    ]
    table = "\n".join([HEAD, *lines])
    print(f"\n{table}")
    (KEPT / "table.md").write_text(table + "\n", encoding="utf-8")
    return 0 if all(result["good"] for result in results) else 1


if __name__ == "__main__":
    sys.exit(main())
