"""Run every torture beside this file and put their figures into one table.

    make torture
    python bench/torture.py [--fresh] [NAME ...]

A torture is a script `torture_NAME.py` that ends with exit code 0 if all is as wanted. Rows
`| what | reached | wanted | good |` among its words (`figures.py`) come into the table.

Those of `ALONE` run one after the other at the end: their laboratory passes in real time. The
others go before, the longest first, one more at once than there are processors, since some mostly
wait. What they count does not depend on how fast they come along; what they measure is memory, or
time of a processor.

One that went well at this commit is not run again: what it said is kept in `build/torture`, so that
an interrupted torture goes on where it was. `--fresh` runs all anew. The table, with date and
commit of each part, is written to `build/torture/table.md`, how long each took to `minutes.md`.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
KEPT = HERE.parent / "build" / "torture"
HEAD = "| figure | reached | wanted | good | date | commit |\n|---|---|---|---|---|---|"
ALONE = ("faults", "real_kills", "soak")
LONGEST = ("coverage", "day_soak", "adversary", "source_kills", "fuzz", "bounds")  # these first


def name_of(script: Path) -> str:
    """Return the name of a torture."""
    return script.stem.removeprefix("torture_")


def commit() -> str:
    """Return the commit that is tortured, with a sign where files differ from it."""
    said = subprocess.run(
        ["git", "describe", "--always", "--dirty", "--abbrev=9"],  # noqa: S607 - git of whoever calls
        cwd=HERE, capture_output=True, text=True, check=False,
    )  # fmt: skip
    return said.stdout.strip() or "no commit"


def run(script: Path, at: str) -> dict[str, Any]:
    """Run one torture, its words passed on; return its rows and whether it went well."""
    name = name_of(script)
    print(f"== {name}", flush=True)
    began = time.monotonic()
    process = subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True)
    rows = []
    for line in process.stdout or ():
        print(f"{name}: {line}", end="", flush=True)
        if line.startswith("| "):
            rows.append(line.rstrip())
    code = process.wait()
    took_s = time.monotonic() - began
    print(f"== {name}: {took_s:.0f} s, exit code {code}", flush=True)
    if code != 0 or not rows:  # what it said without rows stands above the table
        rows.append(f"| {name} | exit code {code} | 0 | {'NO' if code else 'yes'} |")
    date = datetime.now(UTC).date().isoformat()
    return {"commit": at, "date": date, "good": code == 0, "seconds": took_s, "rows": rows}


def kept_or_run(script: Path, at: str, *, fresh: bool) -> dict[str, Any]:
    """Return what a torture said at this commit, or run it."""
    path = KEPT / f"{script.stem}.json"
    if path.exists() and not fresh and not at.endswith("-dirty"):
        kept: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        if kept["commit"] == at and kept["good"]:
            print(f"== {name_of(script)}: went well on {kept['date']}")
            return kept
    found = run(script, at)
    path.write_text(json.dumps(found), encoding="utf-8")
    return found


def all_run(scripts: list[Path], at: str, *, fresh: bool) -> dict[Path, dict[str, Any]]:
    """Run all of them; return what each said."""
    order = [*LONGEST, *sorted({name_of(s) for s in scripts} - {*LONGEST, *ALONE}), *ALONE]
    scripts = sorted(scripts, key=lambda script: order.index(name_of(script)))
    beside = [script for script in scripts if name_of(script) not in ALONE]
    alone = [script for script in scripts if name_of(script) in ALONE]
    processors = os.cpu_count() or 1
    with ThreadPoolExecutor(processors + 1) as pool:
        said = list(pool.map(lambda script: kept_or_run(script, at, fresh=fresh), beside))
    said += [kept_or_run(script, at, fresh=fresh) for script in alone]
    return dict(zip(beside + alone, said, strict=True))


def minutes_of(results: dict[Path, dict[str, Any]], all_s: float) -> str:
    """Return how long each part took, and all of them, as a table."""
    took = {name_of(script): result["seconds"] / 60 for script, result in results.items()}
    beside = sum(minutes for name, minutes in took.items() if name not in ALONE)
    rows = [f"| {name} | {took[name]:.1f} |" for name in sorted(took, key=took.__getitem__)[::-1]]
    load = os.getloadavg()[2]
    whole = f"this run, {os.cpu_count()} processors, a load of {load:.0f} at last"
    rows.append(f"| those beside each other, summed | {beside:.1f} |")
    return "\n".join(["| part | minutes |\n|---|---|", *rows, f"| {whole} | {all_s / 60:.1f} |"])


def main() -> int:
    """Run what is wanted, write the table."""
    wanted = [word for word in sys.argv[1:] if word != "--fresh"]
    scripts = [s for s in sorted(HERE.glob("torture_*.py")) if not wanted or name_of(s) in wanted]
    if not scripts:
        print(f"no torture of that name: {', '.join(wanted)}")
        return 2
    KEPT.mkdir(parents=True, exist_ok=True)
    at = commit()
    begun = time.monotonic()
    results = all_run(scripts, at, fresh="--fresh" in sys.argv)
    lines = [
        f"{row} {results[script]['date']} | {results[script]['commit']} |"
        for script in scripts
        for row in results[script]["rows"]
    ]
    table = "\n".join([HEAD, *lines])
    minutes = minutes_of(results, time.monotonic() - begun)
    print(f"\n{minutes}\n\n{table}")
    (KEPT / "table.md").write_text(table + "\n", encoding="utf-8")
    (KEPT / "minutes.md").write_text(minutes + "\n", encoding="utf-8")
    return 0 if all(result["good"] for result in results.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
