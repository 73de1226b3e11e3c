"""Kill sessions on each source of samples, and the sources, at drawn times; resume; compare.

Every source that can be started here is tortured: a sound file, a sound card in the place of
PortAudio, a module of NI at a gRPC server, a device of openDAQ by native streaming. They are
tortured beside each other: mostly they wait. What is done lies in
`build/torture/source_kills.jsonl`, so that an interrupted run goes on where it was.

    python bench/torture_source_kills.py [--source NAME] [--kills 500] [--seed 1] [--fresh]
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import multiprocessing
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path

import numpy as np
from figures import Figure, told
from torture import commit

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from support.source_devices import SOURCES
from support.source_kills import KilledSession

KILLS_OF_A_JOURNAL = 10
NEEDS = {"ni": ("nidaqmx", "grpc"), "opendaq": ("opendaq",)}
DONE = Path(__file__).resolve().parents[1] / "build" / "torture" / "source_kills.jsonl"


def done(at: str, seed: int) -> list[dict[str, object]]:
    """What was done at this commit with this seed."""
    lines = DONE.read_text(encoding="utf-8").splitlines() if DONE.is_file() else []
    rows = [json.loads(line) for line in lines]
    return [row for row in rows if row["commit"] == at and row["seed"] == seed]


def torture(name: str, part: int, kills: int, seed: int) -> dict[str, object]:
    """Kill the sessions of one journal; the draws depend on source, part and seed alone."""
    rng = np.random.default_rng([seed, sorted(SOURCES).index(name), part])
    with tempfile.TemporaryDirectory() as folder:
        session = KilledSession(name, Path(folder), rng)
        try:
            while session.tally.kills < kills and not session.tally.wrong:
                session.kill_once()
        finally:
            session.close()
    return asdict(session.tally)


def torture_source(name: str, kills: int, seed: int, at: str) -> list[dict[str, object]]:
    """Kill so many sessions on a source, journal after journal; return what came of each."""
    rows = [row for row in done(at, seed) if row["source"] == name]
    for part in range(-(-kills // KILLS_OF_A_JOURNAL)):
        if part in {row["part"] for row in rows}:
            continue
        of_part = min(KILLS_OF_A_JOURNAL, kills - part * KILLS_OF_A_JOURNAL)
        found = torture(name, part, of_part, seed)
        rows.append({"commit": at, "seed": seed, "source": name, "part": part, **found})
        with DONE.open("a", encoding="utf-8") as file:
            file.write(json.dumps(rows[-1]) + "\n")
        print(rows[-1], flush=True)
    return rows


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--source", choices=sorted(SOURCES), action="append")
    parser.add_argument("--kills", type=int, default=500, help="of each source")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--fresh", action="store_true")
    given = parser.parse_args()
    at = commit()
    DONE.parent.mkdir(parents=True, exist_ok=True)
    if given.fresh:
        DONE.unlink(missing_ok=True)
    figures, tortured = [], []
    for name in given.source or sorted(SOURCES):
        if all(importlib.util.find_spec(need) for need in NEEDS.get(name, ())):
            tortured.append(name)
        else:
            print(f"{name}: not installed here", flush=True)
    with ProcessPoolExecutor(len(tortured), multiprocessing.get_context("spawn")) as pool:
        waiting = [
            pool.submit(torture_source, name, given.kills, given.seed, at) for name in tortured
        ]
    for name, result in zip(tortured, waiting, strict=True):
        rows = result.result()
        total = {key: sum(row[key] for row in rows) for key in ("kills", "devices_killed")}
        judged, accepted = (sum(row[key] for row in rows) for key in ("judged", "accepted"))
        wrong = [words for row in rows for words in row["wrong"]]
        print(*wrong, sep="\n")
        figures += [
            Figure(
                f"{name}: sessions killed",
                f"{total['kills']}, {total['devices_killed']} by the device's death",
                str(given.kills),
                total["kills"] >= given.kills,
            ),
            Figure(
                f"{name}: hits told of that are lost, altered or not resumed",
                f"{len(wrong)} of {judged} ({accepted} accepted)",
                "0",
                not wrong and judged > 0,
            ),
        ]
    return told(figures)


if __name__ == "__main__":
    sys.exit(main())
