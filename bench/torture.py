"""Run every torture beside this file and put their figures into one table.

    make torture
    python bench/torture.py [NAME ...]

A torture is a script `torture_NAME.py` that prints rows `| what | reached | wanted | good |`
(`figures.py`) among its other words, and ends with exit code 0 if all is as wanted.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

HEAD = "| figure | reached | wanted | good |\n|---|---|---|---|"


def run(script: Path) -> tuple[list[str], bool]:
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
    if code != 0 or not rows:
        rows.append(f"| {name} ended with code {code} | | 0 | {'NO' if code else 'no figures'} |")
    return rows, code == 0


def main() -> int:
    wanted = sys.argv[1:]
    scripts = sorted(Path(__file__).parent.glob("torture_*.py"))
    scripts = [s for s in scripts if not wanted or s.stem.removeprefix("torture_") in wanted]
    if not scripts:
        print(f"no torture of that name: {', '.join(wanted)}")
        return 2
    results = [run(script) for script in scripts]
    print(f"\n{HEAD}")
    for rows, _ in results:
        print("\n".join(rows))
    return 0 if all(good for _, good in results) else 1


if __name__ == "__main__":
    sys.exit(main())
